// Scene description for the rasteriser.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "format/content/grid.h"
#include "format/content/structure_graph.h"
#include "format/content/surface.h"
#include "player/render/clip/cut_rays.h"
#include "player/render/clip/face_layer.h"
#include "player/render/decode/surface_clusters.h"
#include "player/render/transfer/shading.h"
#include "player/render/view/pixel_box.h"
#include "player/render/view/shear.h"
#include "player/render/view/view_frame.h"

namespace splatlas {

class ViewFaces;

/// A surface with its material.
struct SurfaceDraw {
  const SurfaceMesh* mesh = nullptr;
  const SurfaceClusters* clusters = nullptr;  ///< of the mesh
  StructureIndex structure = kNoStructure;
  std::array<float, 3> color{1, 1, 1};                ///< linear
  float opacity = 1;                                  ///< of each crossing; of a ghost's rim
  std::optional<std::uint32_t> ghost = std::nullopt;  ///< hull that it belongs to

  [[nodiscard]] bool is_opaque() const { return opacity >= 1 && !ghost; }
};

/// The surfaces of a view.
struct RasterScene {
  std::span<const SurfaceDraw> surfaces;
  PictureSize size;
  PixelBox region;  ///< pixels to draw, within the picture
  Projection projection;
  const Lighting& lighting;
  std::size_t depth_axis = 2;               ///< axis of the grid: depth_axis() of the view
  double depth_sign = 1;                    ///< depth is depth_sign * index along depth_axis
  float pixel_voxels = 1;                   ///< width of a pixel in voxels of depth_axis
  const CutRays* cuts = nullptr;            ///< clips surfaces; null: no cut
  const FaceLayer* faces = nullptr;         ///< of the pixel centres; null: none
  const ViewFaces* sample_faces = nullptr;  ///< of all other samples; with `faces`
};
/// The scene of a whole parallel view; arguments must outlive it.
[[nodiscard]] inline RasterScene raster_scene(std::span<const SurfaceDraw> surfaces, const ParallelView& view,
                                              const Shear& shear, const Grid& grid,
                                              const Lighting& lighting) {
  const Vec3 along = lps_mm_to_index(grid).apply_linear(view.forward_lps);
  const double voxels_per_mm = std::abs(along[shear.scan.slice_axis]);
  return {surfaces,
          view.size,
          PixelBox::of(view.size),
          Projection(view, grid),
          lighting,
          shear.scan.slice_axis,
          shear.ascending ? 1.0 : -1.0,
          static_cast<float>(view.mm_per_pixel * voxels_per_mm)};
}

}  // namespace splatlas
