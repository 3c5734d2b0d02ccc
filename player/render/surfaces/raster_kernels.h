// Kernels of the rasteriser (hot loops). Arrays are readable and writable for kRasterPadding elements more.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "player/render/surfaces/screen_triangle.h"
#include "player/render/view/view_frame.h"

namespace splatlas {

/// Kernels process whole vectors of at most as many lanes.
inline constexpr std::size_t kRasterPadding = 16;

/// Vertices on the screen, in arrays for SIMD.
struct ScreenVertices {
  double *x, *y;                        ///< ScreenPoint
  std::int32_t *snapped_x, *snapped_y;  ///< ScreenVertex
};

struct RasterKernels {
  /// Projects `count` vertices in a parallel view, and snaps them. False without a result if one is off
  /// the screen: outside the guard band, or not finite. Also where vectors have no doubles.
  bool (*place)(const Projection& projection, const std::array<const float*, 3>& ijk, std::size_t count,
                const ScreenVertices& out);
  /// Finds the triangles whose pixels_of() with this reach meet a box. Corners: one byte each, the first in
  /// the lowest byte. Returns their number.
  std::size_t (*select)(const std::uint32_t* corners, std::size_t count, const ScreenVertices& vertices,
                        const PixelBox& box, std::int32_t reach, std::uint32_t* out);
  /// Finds the pixels inside, one word for each row, and one bit for each column.
  void (*cover)(const SmallEdges& edges, std::int32_t columns, std::int32_t rows, std::uint32_t* out);
};

/// The kernels of the best instruction set; all give the same results.
[[nodiscard]] const RasterKernels& raster_kernels();

}  // namespace splatlas
