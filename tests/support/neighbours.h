// Visits of all voxels, and the brute-force definition of boundary voxels.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <vector>

#include "format/content/grid.h"
#include "format/content/run_model.h"

namespace splatlas {

/// Calls `visit(index)` for every voxel in memory order, i fastest.
template <typename Visit>
void for_each_voxel(const Index3& size, const Visit& visit) {
  for (std::int64_t k = 0; k < size[2]; ++k) {
    for (std::int64_t j = 0; j < size[1]; ++j) {
      for (std::int64_t i = 0; i < size[0]; ++i) visit(Index3{i, j, k});
    }
  }
}

/// True if `holds(index)` is false for a voxel that shares a face or an edge with `at`, or for `at`.
template <typename Holds>
bool is_boundary(const Index3& at, const Holds& holds) {
  for (std::int64_t n = 0; n < 27; ++n) {
    const Index3 step{n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
    if (std::abs(step[0]) + std::abs(step[1]) + std::abs(step[2]) > 2) continue;
    if (!holds(Index3{at[0] + step[0], at[1] + step[1], at[2] + step[2]})) return true;
  }
  return false;
}

/// Predicate: true if a voxel is in a mask, i fastest; false outside the grid. Keeps a reference to `mask`.
template <typename Mask>
auto holds_in(const Mask& mask, const Index3& size) {
  return [&mask, size](const Index3& at) {
    for (std::size_t a = 0; a < 3; ++a) {
      if (at[a] < 0 || at[a] >= size[a]) return false;
    }
    return static_cast<bool>(mask[static_cast<std::size_t>((at[2] * size[1] + at[1]) * size[0] + at[0])]);
  };
}

/// For every voxel of a mask: 0 outside, 1 interior, 2 boundary.
template <typename Mask>
std::vector<ClassId> split_by_definition(const Mask& mask, const Index3& size) {
  const auto holds = holds_in(mask, size);
  std::vector<ClassId> parts;
  for_each_voxel(size, [&](const Index3& at) {
    parts.push_back(!holds(at) ? 0u : is_boundary(at, holds) ? 2u : 1u);
  });
  return parts;
}

}  // namespace splatlas
