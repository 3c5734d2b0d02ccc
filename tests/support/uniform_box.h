// Uniform boxes, whose opacity has a closed form.
#pragma once

#include <cmath>

#include "tests/support/test_content.h"

namespace splatlas {

/// A box of `size` voxels of 1 mm: one structure "box" without grey values.
[[nodiscard]] inline AtlasContent box_content(const Index3& size) {
  TestVolume volume;
  volume.grid.size = size;
  volume.structures = {{"box", full_mask(size)}};
  return make_content(volume);
}

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
