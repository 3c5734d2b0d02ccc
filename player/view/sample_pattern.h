// Where within a pixel the surfaces are sampled.
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace splatlas {

inline constexpr int kSubPixelBits = 8;

/// A point of a pixel, from its centre, in 1/256 pixel: vertices snap to the same grid, so that every sample
/// is as watertight as the centres are.
struct SubPixel {
  std::int16_t x = 0, y = 0;

  /// From the pixel's left and upper border, in pixels.
  [[nodiscard]] double right() const { return 0.5 + x / 256.0; }
  [[nodiscard]] double down() const { return 0.5 + y / 256.0; }
};

/// The centre alone.
inline constexpr std::array<SubPixel, 1> kCentre{{{0, 0}}};
/// Four and eight points, no two in one row or column: edges near the horizontal and vertical get as many
/// steps as there are points.
inline constexpr std::array<SubPixel, 4> kFourSamples{{{-32, -96}, {96, -32}, {-96, 32}, {32, 96}}};
inline constexpr std::array<SubPixel, 8> kEightSamples{
    {{16, -48}, {-16, 48}, {80, 16}, {-48, -80}, {-80, 80}, {-112, -16}, {48, 112}, {112, -112}}};

/// Of a pixel that holds so many samples: 1, 4 or 8.
[[nodiscard]] inline std::span<const SubPixel> sample_pattern(std::size_t samples) {
  if (samples == kFourSamples.size()) return kFourSamples;
  if (samples == kEightSamples.size()) return kEightSamples;
  return kCentre;
}

}  // namespace splatlas
