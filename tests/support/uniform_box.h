// Uniform boxes, whose opacity has a closed form.
#pragma once

#include <array>
#include <cmath>
#include <utility>

#include "tests/support/test_content.h"

namespace splatlas {

/// A box of `size` voxels of 1 mm: one structure "box" without grey values.
[[nodiscard]] inline AtlasContent box_content(const Index3& size) {
  TestVolume volume;
  volume.grid.size = size;
  volume.structures = {{"box", make_mask(size, [](auto...) { return true; })}};
  return make_content(volume);
}

/// Azimuths and elevations of views whose rays cross the large faces of a plate that is thin along y.
inline constexpr std::array<std::pair<double, double>, 6> kPlateDirections{
    {{0.0, 0.0}, {1e-6, 0.0}, {17.3, 0.0}, {-31.0, 20.0}, {44.99, 0.0}, {0.0, -40.0}}};

/// All structures as volume.
[[nodiscard]] inline Selection with_opacity(const AtlasContent& content, float opacity) {
  Selection selection = selection_of("*:volume", content.graph);
  for (StructureDraw& draw : selection.structures) draw.opacity = opacity;
  return selection;
}

/// Opacity of `length` reference lengths at the maximum opacity.
[[nodiscard]] inline double opacity_through(double length, float per_length) {
  return -std::expm1(length * std::log1p(-static_cast<double>(per_length)));
}

}  // namespace splatlas
