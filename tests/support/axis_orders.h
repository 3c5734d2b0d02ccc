// Enumeration of axis orders.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "format/content/grid.h"

namespace splatlas {

/// The 48 signed permutations of three axes.
inline std::vector<AxisOrder> all_axis_orders() {
  std::vector<AxisOrder> orders;
  std::array<std::uint8_t, 3> from{0, 1, 2};
  do {
    for (unsigned flips = 0; flips < 8; ++flips)
      orders.push_back({from, {(flips & 1u) != 0, (flips & 2u) != 0, (flips & 4u) != 0}});
  } while (std::next_permutation(from.begin(), from.end()));
  return orders;
}

}  // namespace splatlas
