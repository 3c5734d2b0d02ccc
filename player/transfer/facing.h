// Which side of a triangle is seen.
#pragma once

#include <array>

#include "format/grid.h"
#include "format/surface.h"

namespace splatlas {

/// Front is where the normals of a triangle's corners point. The side that is seen is told by the triangle
/// itself, not by the interpolated normal: at a silhouette that one points past the edge already while the
/// front is still in view.
class Facing {
 public:
  explicit Facing(const Grid& grid);

  /// `clockwise`: so the corners are seen, in their order. True where their normals do not tell the front
  /// (zero, not a number, along the triangle).
  [[nodiscard]] bool shows_front(const SurfaceMesh& mesh, const std::array<std::uint32_t, 3>& corners,
                                 bool clockwise) const;

 private:
  std::array<Vec3, 3> normal_to_lps_{};  // rows: the cofactors of the grid's matrix
};

}  // namespace splatlas
