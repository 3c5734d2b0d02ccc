// The classes that each structure is made of.
#pragma once

#include <span>
#include <vector>

#include "format/class_table.h"

namespace splatlas {

/// A class whose voxels a structure holds: Part::kInterior or Part::kBoundary.
struct HeldClass {
  ClassId id = kEmptyClass;
  Part part = Part::kInterior;
};

/// Memberships by structure, so that what is asked of one structure costs its own classes, not all of them.
/// Cost: 8 bytes a membership, and two walks over them.
class HeldClasses {
 public:
  /// Members' structures must be below `structures`.
  HeldClasses(const ClassTable& classes, std::size_t structures);

  /// By rising number; classes that the structure's surface merely crosses are left out.
  [[nodiscard]] std::span<const HeldClass> of(StructureIndex structure) const {
    return std::span(held_).subspan(first_[structure], first_[structure + 1] - first_[structure]);
  }

 private:
  std::vector<HeldClass> held_;
  std::vector<std::size_t> first_;  // [structure], and the end
};

/// The box around the voxels of these classes.
[[nodiscard]] IndexBox box_of(const ClassTable& classes, std::span<const HeldClass> held);

}  // namespace splatlas
