// Surface fragments: what a triangle leaves in one pixel.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "format/structure_graph.h"

namespace splatlas {

/// The image of everything in front of some depth: premultiplied linear colour, and opacity. Opacity, not
/// what still shines through, because small opacities keep their digits: a thousand layers of 1e-8 add up to
/// 1e-5.
struct Light {
  std::array<float, 4> rgba{0, 0, 0, 0};
};

/// One surface sample at a pixel's centre.
struct Fragment {
  float depth = 0;              ///< along the principal axis in voxels, growing away from the viewer
  std::uint32_t pixel = 0;      ///< y * width + x
  std::array<float, 4> rgba{};  ///< premultiplied, linear
  StructureIndex structure = kNoStructure;
};

/// Fragments of a picture, by pixel, front to back within a pixel. The volume pass fills `above` and `below`:
/// the volume in front of fragment n, as the two rows of the sheet next to it contribute (their sum is the
/// volume in front of the fragment, interpolated as the warp will interpolate the finished sheet).
struct FragmentList {
  std::vector<Fragment> fragments;
  std::vector<std::uint32_t> first_of_row;  ///< height + 1 offsets, per picture row
  std::vector<Light> above, below;

  [[nodiscard]] std::span<const Fragment> row(int y) const {
    const auto n = static_cast<std::size_t>(y);
    return std::span(fragments).subspan(first_of_row[n], first_of_row[n + 1] - first_of_row[n]);
  }
};

}  // namespace splatlas
