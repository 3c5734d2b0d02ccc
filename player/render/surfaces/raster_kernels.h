// Kernels of the rasteriser (hot loops). Arrays are readable and writable for kRasterPadding elements more.
#pragma once

#include <cstddef>
#include <cstdint>

#include "player/render/surfaces/screen_triangle.h"

namespace splatlas {

/// Kernels process whole vectors of at most as many lanes.
inline constexpr std::size_t kRasterPadding = 16;

/// ScreenVertex in arrays for SIMD.
struct SnappedVertices {
  const std::int32_t *x, *y;
};

// By the best instruction set; all give the same results.

/// Finds the triangles whose pixels_of() with this reach meet a box. Corners: one byte each, the first in the
/// lowest byte. Returns their number.
std::size_t select_triangles(const std::uint32_t* corners, std::size_t count, const SnappedVertices& vertices,
                             const PixelBox& box, std::int32_t reach, std::uint32_t* out);
/// Finds the pixels inside, one word for each row, and one bit for each column.
void cover_pixels(const SmallEdges& edges, std::int32_t columns, std::int32_t rows, std::uint32_t* out);

}  // namespace splatlas
