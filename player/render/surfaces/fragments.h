// A-buffer fragments (Carpenter 1984).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "format/content/structure_graph.h"
#include "player/render/clip/face_layer.h"
#include "player/render/view/pixel_box.h"

namespace splatlas {

/// Radiance and opacity accumulated up to some depth: linear RGB, premultiplied, and alpha. Opacity instead
/// of transmittance keeps the precision of small values: a thousand layers of 1e-8 add up to 1e-5.
struct Radiance {
  std::array<float, 4> rgba{0, 0, 0, 0};

  Radiance& operator+=(const Radiance& other) {
    for (std::size_t c = 0; c < 4; ++c) rgba[c] += other.rgba[c];
    return *this;
  }
};

/// Radiance of a volume of one colour, from that of white.
[[nodiscard]] inline Radiance in_color(float white, float opacity, const std::array<float, 3>& color) {
  return {{white * color[0], white * color[1], white * color[2], opacity}};
}

/// Intersection of a surface with the ray of a sample.
struct Fragment {
  float depth = 0;              ///< along the principal axis in voxels, growing away from the viewer
  std::array<float, 4> rgba{};  ///< premultiplied, linear
  StructureIndex structure = kNoStructure;
};

/// Sample position of a pixel, with its fragments.
struct Sample {
  std::uint32_t pixel = 0;           ///< y * width + x
  std::uint32_t first_fragment = 0;  ///< its fragments end at the first one of the next sample
  SubPixel place;                    ///< within the pixel

  /// Picture coordinates in a picture of `width` columns.
  [[nodiscard]] double x(int width) const {
    return pixel % static_cast<std::uint32_t>(width) + place.right();
  }
  [[nodiscard]] double y(int width) const {
    const std::uint32_t row = pixel / static_cast<std::uint32_t>(width);
    return row + place.down();
  }
};

/// Fragments of a picture, front to back within each sample; samples in pixel order. A pixel is the mean of
/// its samples; pixels without surfaces have none. The last element of `samples` is a sentinel.
struct FragmentList {
  std::vector<Fragment> fragments;
  std::vector<Sample> samples{Sample{}};
  std::vector<std::uint32_t> first_of_row;  ///< height + 1 offsets of samples, per picture row
  std::vector<RayFaces> faces;              ///< of the samples; empty without faces of cuts

  /// Removes all fragments of a picture of this size.
  void clear(const PictureSize& size) {
    fragments.clear();
    samples.assign(1, Sample{});
    first_of_row.assign(static_cast<std::size_t>(size.height) + 1, 0);
  }
  [[nodiscard]] std::size_t sample_count() const { return samples.size() - 1; }
  [[nodiscard]] std::span<const Fragment> of_sample(std::size_t n) const {
    return std::span(fragments).subspan(samples[n].first_fragment,
                                        samples[n + 1].first_fragment - samples[n].first_fragment);
  }
};

}  // namespace splatlas
