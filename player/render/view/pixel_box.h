// Rectangles of pixels, and patterns of samples in a pixel.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "player/camera.h"

namespace splatlas {

/// Rectangle of pixels, with both ends included.
struct PixelBox {
  std::int32_t x_first = 0, x_last = -1, y_first = 0, y_last = -1;

  /// All pixels of a picture.
  [[nodiscard]] static PixelBox of(const PictureSize& size) {
    return {0, size.width - 1, 0, size.height - 1};
  }

  [[nodiscard]] bool empty() const { return x_first > x_last || y_first > y_last; }
  [[nodiscard]] std::int32_t width() const { return x_last - x_first + 1; }
  [[nodiscard]] std::int32_t height() const { return y_last - y_first + 1; }
  [[nodiscard]] std::size_t pixels() const {
    return empty() ? 0 : static_cast<std::size_t>(width()) * static_cast<std::size_t>(height());
  }
  /// Place of a pixel among those of the rectangle, row by row.
  [[nodiscard]] std::size_t place(std::int32_t x, std::int32_t y) const {
    return static_cast<std::size_t>(y - y_first) * static_cast<std::size_t>(width()) +
           static_cast<std::size_t>(x - x_first);
  }
  [[nodiscard]] bool contains(std::int32_t x, std::int32_t y) const {
    return x >= x_first && x <= x_last && y >= y_first && y <= y_last;
  }
  /// With `by` more pixels on each side.
  [[nodiscard]] PixelBox grown(std::int32_t by) const {
    return {x_first - by, x_last + by, y_first - by, y_last + by};
  }
};

[[nodiscard]] inline PixelBox intersection(const PixelBox& a, const PixelBox& b) {
  return {std::max(a.x_first, b.x_first), std::min(a.x_last, b.x_last), std::max(a.y_first, b.y_first),
          std::min(a.y_last, b.y_last)};
}

inline constexpr int kSubPixelBits = 8;
inline constexpr double kSubPixels = 1 << kSubPixelBits;

/// A sample position relative to the pixel centre, in 1/256 pixel. Vertices snap to the same grid, so that
/// rasterisation is watertight at every sample.
struct SubPixel {
  std::int16_t x = 0, y = 0;

  /// Distances from the pixel's left and upper border, in pixels.
  [[nodiscard]] double right() const { return 0.5 + x / 256.0; }
  [[nodiscard]] double down() const { return 0.5 + y / 256.0; }
};

/// The pixel centre.
inline constexpr std::array<SubPixel, 1> kCentre{{{0, 0}}};
/// N-rooks patterns of four and eight points. No two points share a row or column, so that edges near the
/// horizontal and the vertical get the full number of coverage levels.
inline constexpr std::array<SubPixel, 4> kFourSamples{{{-32, -96}, {96, -32}, {-96, 32}, {32, 96}}};
inline constexpr std::array<SubPixel, 8> kEightSamples{
    {{16, -48}, {-16, 48}, {80, 16}, {-48, -80}, {-80, 80}, {-112, -16}, {48, 112}, {112, -112}}};

/// The pattern of `samples` points: 1, 4 or 8.
[[nodiscard]] inline std::span<const SubPixel> sample_pattern(std::size_t samples) {
  if (samples == kFourSamples.size()) return kFourSamples;
  if (samples == kEightSamples.size()) return kEightSamples;
  return kCentre;
}

}  // namespace splatlas
