// Surface fragments: what a triangle leaves in one pixel.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "format/structure_graph.h"
#include "player/view/sample_pattern.h"

namespace splatlas {

/// The image of everything in front of some depth: premultiplied linear colour, and opacity. Opacity, not
/// what still shines through, because small opacities keep their digits: a thousand layers of 1e-8 add up to
/// 1e-5.
struct Light {
  std::array<float, 4> rgba{0, 0, 0, 0};

  Light& operator+=(const Light& other) {
    for (std::size_t c = 0; c < 4; ++c) rgba[c] += other.rgba[c];
    return *this;
  }
};

/// Of a volume of one colour.
[[nodiscard]] inline Light in_color(float white, float opacity, const std::array<float, 3>& color) {
  return {{white * color[0], white * color[1], white * color[2], opacity}};
}

/// A surface where the ray of a sample crosses it.
struct Fragment {
  float depth = 0;              ///< along the principal axis in voxels, growing away from the viewer
  std::array<float, 4> rgba{};  ///< premultiplied, linear
  StructureIndex structure = kNoStructure;
};

/// A point of a pixel whose ray has been followed through the surfaces.
struct Sample {
  std::uint32_t pixel = 0;           ///< y * width + x
  std::uint32_t first_fragment = 0;  ///< of its fragments, which end where the next sample's begin
  SubPixel place;                    ///< in the pixel
};

/// The volume in front of a slab and with it: what the warp would show if the volume ended there.
struct SlabRadiance {
  Light before, behind;
};

/// Fragments of a picture by sample, front to back within a sample; samples by pixel. A pixel is the mean of
/// its samples, one or several; one without any shows no surface. The last sample is one behind the end.
struct FragmentList {
  std::vector<Fragment> fragments;
  std::vector<Sample> samples{Sample{}};
  std::vector<std::uint32_t> first_of_row;  ///< height + 1 offsets of samples, per picture row

  [[nodiscard]] std::size_t sample_count() const { return samples.size() - 1; }
  [[nodiscard]] std::span<const Fragment> of_sample(std::size_t n) const {
    return std::span(fragments).subspan(samples[n].first_fragment,
                                        samples[n + 1].first_fragment - samples[n].first_fragment);
  }
};

}  // namespace splatlas
