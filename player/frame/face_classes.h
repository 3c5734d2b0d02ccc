// Structures that the faces of a cut show.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "format/class_table.h"
#include "format/decision_tree.h"
#include "format/selection.h"

namespace splatlas {

/// Face of the voxels of one class.
struct FaceClass {
  static constexpr std::uint32_t kEveryVoxel = std::numeric_limits<std::uint32_t>::max();

  StructureIndex structure = kNoStructure;  ///< kNoStructure: no face
  float opacity = 0;
  std::array<float, 3> color{};  ///< linear RGB
  /// Index into the plan's classes. Voxels to which its transfer function gives no extinction have no face.
  std::uint32_t draw = kEveryVoxel;

  [[nodiscard]] bool has_face() const { return structure != kNoStructure; }
};

/// Faces by ClassId. If several selected structures contain a voxel, its face is that of the latest term;
/// within a term, of the structure with the higher index. A structure drawn as surface is a solid with the
/// opacity of its surface. A volume has its full opacity. `plan` must be the plan of `selection`. Cost:
/// linear in the classes and their memberships.
[[nodiscard]] std::vector<FaceClass> face_classes(const ClassTable& classes, const Selection& selection,
                                                  const DrawPlan& plan);

}  // namespace splatlas
