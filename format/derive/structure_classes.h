// Index of the classes inside each structure.
#pragma once

#include <span>
#include <vector>

#include "format/content/class_table.h"

namespace splatlas {

/// A class inside a structure: Part::kInterior or Part::kBoundary.
struct StructureClass {
  ClassId id = kEmptyClass;
  Part part = Part::kInterior;
};

/// Memberships by structure. A lookup costs only the classes of one structure. Memory: 8 bytes per
/// membership. Construction: linear in the memberships.
class StructureClasses {
 public:
  /// All structures of memberships must be below `structures`.
  StructureClasses(const ClassTable& classes, std::size_t structures);

  /// Classes inside the structure in ascending order, without those that only its surface crosses.
  [[nodiscard]] std::span<const StructureClass> of(StructureIndex structure) const {
    return std::span(list_).subspan(first_[structure], first_[structure + 1] - first_[structure]);
  }

 private:
  std::vector<StructureClass> list_;
  std::vector<std::size_t> first_;  // [structure], size + 1 offsets
};

/// Bounding box of the voxels of these classes.
[[nodiscard]] IndexBox box_of(const ClassTable& classes, std::span<const StructureClass> members);

}  // namespace splatlas
