// Scene description for the rasteriser, and facing of triangles.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "format/content/grid.h"
#include "format/content/surface.h"
#include "player/render/clip/cut_rays.h"
#include "player/render/clip/face_layer.h"
#include "player/render/surfaces/triangle_bins.h"
#include "player/render/transfer/shading.h"
#include "player/render/view/shear.h"
#include "player/render/view/view_frame.h"

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

struct RasterScene {
  std::span<const SurfaceDraw> surfaces;
  PictureSize size;
  Projection projection;
  Facing facing;
  const Lighting& lighting;
  std::size_t depth_axis = 2;        ///< axis of the grid: depth_axis() of the view
  double depth_sign = 1;             ///< depth is depth_sign * index along depth_axis
  float pixel_voxels = 1;            ///< width of a pixel in voxels of depth_axis
  const CutRays* cuts = nullptr;     ///< clips surfaces; null: no cut
  const FaceLayer* faces = nullptr;  ///< of the pixel centres; null: none
};
/// The scene of a parallel view; arguments must outlive it.
[[nodiscard]] RasterScene raster_scene(std::span<const SurfaceDraw> surfaces, const ParallelView& view,
                                       const Shear& shear, const Grid& grid, const Lighting& lighting);

}  // namespace splatlas
