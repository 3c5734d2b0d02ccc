// Front and back faces of a triangle.
#pragma once

#include <array>

#include "format/grid.h"
#include "format/surface.h"

namespace splatlas {

/// Two-sided facing test. Vertex normals define the front face, and the geometric normal decides the visible
/// side. An interpolated normal would fail at silhouettes: it turns away while the front is still visible.
class Facing {
 public:
  explicit Facing(const Grid& grid);

  /// True if the front face is visible; `clockwise` is the winding of the corners on the screen. Also true
  /// where the vertex normals define no front (zero, NaN, in the plane of the triangle).
  [[nodiscard]] bool shows_front(const SurfaceMesh& mesh, const std::array<std::uint32_t, 3>& corners,
                                 bool clockwise) const;

 private:
  std::array<Vec3, 3> normal_to_lps_{};  // rows: the cofactors of the grid's matrix
};

}  // namespace splatlas
