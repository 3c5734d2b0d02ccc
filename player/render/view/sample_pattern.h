// Supersampling patterns of a pixel.
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace splatlas {

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
