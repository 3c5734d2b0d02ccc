// Pictures in linear light, and structures picked in them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "format/color.h"
#include "format/grid.h"
#include "format/structure_graph.h"
#include "player/camera.h"

namespace splatlas {

/// RGBA floats, linear light, colours premultiplied by alpha; top row first.
struct Picture {
  PictureSize size;
  std::vector<float> rgba;  ///< 4 * width * height

  [[nodiscard]] std::array<float, 4> at(int x, int y) const {
    const std::size_t n = 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width) +
                               static_cast<std::size_t>(x));
    return {rgba[n], rgba[n + 1], rgba[n + 2], rgba[n + 3]};
  }
};

/// The structure that contributes most to a pixel, and the point on its ray with the largest contribution.
struct Pick {
  StructureIndex structure = kNoStructure;
  Vec3 point_lps_mm{0, 0, 0};
};

/// Memory that a picture of this size needs on its way to a file: its floats, and as much again to encode
/// them.
[[nodiscard]] constexpr std::uint64_t picture_bytes(const PictureSize& size) {
  constexpr std::uint64_t kBytesPerPixel = std::uint64_t{2} * 4 * sizeof(float);
  return kBytesPerPixel * static_cast<std::uint64_t>(size.width) * static_cast<std::uint64_t>(size.height);
}

/// Over a background, as 8-bit sRGB triples. Here and in to_srgba8() values are rounded, and nowhere else;
/// what is no number counts as 0.
[[nodiscard]] std::vector<std::uint8_t> to_srgb8(const Picture& picture, Rgb background);

/// As 8-bit sRGB with straight (not premultiplied) alpha, for files with a transparent background.
[[nodiscard]] std::vector<std::uint8_t> to_srgba8(const Picture& picture);

}  // namespace splatlas
