// Kept fractions of a cut slab along rows of pixels.
#pragma once

#include <cstdint>

namespace splatlas {

/// Kept fraction of a slab along a row of pixels: at_whole + per_pixel * (x - whole) at pixel x, clamped to
/// [0, 1]. Exact near `whole`, where it is between 0 and 1.
struct ClipLine {
  float at_whole = 1, per_pixel = 0;
  std::int32_t whole = 0;
};

/// Pixels of all phase rows of a pair: outside the visible ones the fraction is 0, among the whole ones it
/// is 1. Either may be empty.
struct ClipPixels {
  std::int64_t first_visible = 0, last_visible = 0, first_whole = 0, last_whole = 0;
};

/// Kept fraction of a slab that planes cut: max(0, e + l - 1), with the smallest fraction e of the planes
/// where rays enter, and l of those where they leave. Without planes the slab is whole.
struct ClipRows {
  const ClipPixels* pixels = nullptr;  ///< of each pair
  const ClipLine* lines = nullptr;  ///< of the planes of the first phase row; those of entering planes first
  int entering = 0, planes = 0;
  std::int64_t pair_stride = 0, row_stride = 0, phase_stride = 0;  ///< in lines
};

}  // namespace splatlas
