// Slow smoothing of surfaces, written from docs/atlas_surfaces.md alone.
#pragma once

#include <array>
#include <cstdint>
#include <map>

#include "tests/format/derive/masks.h"

namespace splatlas::plain {

/// A crossed edge: its first voxel, and its axis.
using Edge = std::array<std::int64_t, 4>;

struct SmoothVertex {
  std::int64_t offset = 0;  ///< from the first voxel, in 1/256 voxel
  std::array<std::int64_t, 3> direction{0, 0, 0};
  friend bool operator==(const SmoothVertex&, const SmoothVertex&) = default;
};

/// The vertices of a mask's surface.
[[nodiscard]] std::map<Edge, SmoothVertex> smooth_vertices(const Mask& mask);

}  // namespace splatlas::plain
