// Structures that the faces of a cut show.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "format/content/class_table.h"
#include "format/content/decision_tree.h"
#include "format/content/selection.h"

namespace splatlas {

/// Appearance of a structure's faces.
struct FaceStyle {
  StructureIndex structure = kNoStructure;  ///< kNoStructure: no face
  std::uint32_t term = 0;                   ///< of the selection
  float opacity = 0;
  std::array<float, 3> color{};  ///< linear RGB

  [[nodiscard]] bool has_face() const { return structure != kNoStructure; }
  /// True if this face hides another one at the same point: its term is later, or within a term its index.
  [[nodiscard]] bool hides(const FaceStyle& other) const {
    return has_face() &&
           (!other.has_face() || std::pair(term, structure) > std::pair(other.term, other.structure));
  }
};

/// Face of the voxels of one class.
struct FaceClass : FaceStyle {
  static constexpr std::uint32_t kEveryVoxel = std::numeric_limits<std::uint32_t>::max();

  /// Index into the plan's classes. Its transfer function tells how much of a voxel has a face.
  /// kEveryVoxel for solids, and for a volume whose voxels are drawn as those of another structure.
  std::uint32_t draw = kEveryVoxel;
};

/// True if the faces of a structure are those of a solid: it is drawn as surface, and not as ghost.
[[nodiscard]] inline bool is_solid(const StructureDraw& draw) {
  return (draw.mode == DrawMode::kSurface || draw.mode == DrawMode::kBoth) && !draw.ghost;
}
/// The style of a solid, which has the opacity of its surface.
[[nodiscard]] FaceStyle solid_style(StructureIndex structure, const Selection& selection);
/// The style of a structure's voxels: of a solid if it is one. Volumes have full opacity, ghosts no face.
[[nodiscard]] FaceStyle face_style(StructureIndex structure, const Selection& selection);

/// Faces by ClassId. If several selected structures contain a voxel, the face is that of the latest term;
/// within a term, of the structure with the higher index. `plan` must be the plan of `selection`. Structures
/// of `without` (by StructureIndex; may be empty) have none. Linear in the memberships.
[[nodiscard]] std::vector<FaceClass> face_classes(const ClassTable& classes, const Selection& selection,
                                                  const DrawPlan& plan,
                                                  const std::vector<bool>& without = {});

}  // namespace splatlas
