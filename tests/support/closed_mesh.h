// Meshes without a border.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>

#include "format/content/grid.h"

namespace splatlas {

/// True if each edge of `triangles`, which are corners by number, occurs as often in both directions.
template <typename Triangles>
bool is_closed(const Triangles& triangles) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
  for (const auto& t : triangles) {
    for (std::size_t n = 0; n < 3; ++n) {
      ++balance[{t[n], t[(n + 1) % 3]}];
      --balance[{t[(n + 1) % 3], t[n]}];
    }
  }
  return std::ranges::all_of(balance, [](const auto& edge) { return edge.second == 0; });
}

/// Volume within, in units of `corner(vertex)`; positive if triangles are counter-clockwise from outside.
template <typename Triangles, typename Corner>
double enclosed_volume(const Triangles& triangles, const Corner& corner) {
  double sixfold = 0;
  for (const auto& [a, b, c] : triangles) sixfold += dot(corner(a), cross(corner(b), corner(c)));
  return sixfold / 6;
}

}  // namespace splatlas
