// Means of the optical properties of blocks of voxels, in double precision.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "format/content/grid.h"
#include "tests/reference/optical_field.h"
#include "tests/support/test_content.h"

namespace splatlas {

/// A slab. Its blocks have one normal each, so that lighting their means is exact; normals of its rim bend.
inline TestVolume slab() {
  TestVolume volume;
  volume.grid.size = {33, 31, 24};
  volume.structures = {
      {"slab", make_mask(volume.grid.size, [](auto, auto, auto k) { return k > 4 && k < 19; })}};
  return volume;
}

/// Means over blocks, from the reference.
inline std::vector<reference::VoxelOptics> means_of(const reference::OpticalField& field, const Grid& grid,
                                                    int level) {
  const Grid coarse = coarse_grid(grid, level);
  std::vector<reference::VoxelOptics> means(static_cast<std::size_t>(coarse.voxels()));
  for (std::int64_t k = 0; k < grid.size[2]; ++k) {
    for (std::int64_t j = 0; j < grid.size[1]; ++j) {
      for (std::int64_t i = 0; i < grid.size[0]; ++i) {
        means[static_cast<std::size_t>(coarse.offset(i >> level, j >> level, k >> level))].add(
            std::ldexp(1.0, -3 * level), field.voxels[static_cast<std::size_t>(grid.offset(i, j, k))]);
      }
    }
  }
  return means;
}

/// Compares optical properties, relative to the extinction of each block.
inline void expect_near(const std::vector<reference::VoxelOptics>& ours,
                        const std::vector<reference::VoxelOptics>& expected, double tolerance) {
  ASSERT_EQ(ours.size(), expected.size());
  for (std::size_t n = 0; n < ours.size(); ++n) {
    const double scale = expected[n].extinction;
    ASSERT_NEAR(ours[n].extinction, scale, 1e-5 * scale + 1e-38) << "block " << n;
    for (std::size_t c = 0; c < 3; ++c)
      ASSERT_NEAR(ours[n].emission[c], expected[n].emission[c], tolerance * scale + 1e-38) << "block " << n;
  }
}

/// Compares the middle of the lit slab() in blocks of two voxels: normals of its rim bend.
inline void expect_lit(const std::vector<reference::VoxelOptics>& ours,
                       const std::vector<reference::VoxelOptics>& expected) {
  const Grid coarse = coarse_grid(slab().grid, 1);
  std::uint64_t lit = 0;
  for (std::int64_t k = 0; k < coarse.size[2]; ++k) {
    const auto n = static_cast<std::size_t>(coarse.offset(8, 8, k));
    ASSERT_NEAR(ours[n].emission[0], expected[n].emission[0], 1e-4 * expected[n].extinction) << k;
    if (expected[n].emission[0] < 0.999 * expected[n].extinction) ++lit;
  }
  EXPECT_GE(lit, 2u);
}

}  // namespace splatlas
