#include "player/render/sheets/splat/slice_mix.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "player/render/sheets/spans/span_writer.h"

namespace splatlas {
namespace {

constexpr std::int64_t kRows = 9;
constexpr std::int64_t kVoxels = 130;

/// Rows of voxels: extinction and emission of each.
using Dense = std::vector<std::array<float, 2>>;

Dense random_voxels(std::mt19937& random) {
  Dense voxels(kRows * kVoxels);
  std::uniform_real_distribution<float> value(0.1f, 1);
  bool lit = false;
  for (auto& voxel : voxels) {
    if (random() % 25 == 0) lit = !lit;
    if (lit) voxel = {value(random), value(random)};
  }
  if (random() % 3 == 0) std::fill_n(voxels.begin(), kVoxels * (random() % kRows), std::array<float, 2>{});
  return voxels;
}

SliceSpans slice_of(const Dense& voxels) {
  SliceSpans slice;
  SpanWriter writer(1, slice);
  for (std::int64_t row = 0; row < kRows; ++row) {
    for (std::uint32_t n = 0; n < kVoxels; ++n) {
      const auto& voxel = voxels[static_cast<std::size_t>(row * kVoxels + n)];
      if (voxel[0] <= 0) continue;
      writer.add(n, 1);
      *writer.extinctions(n) = voxel[0];
      *writer.emissions(n, 0) = voxel[1];
    }
    writer.end_row(row);
  }
  writer.finish();
  return slice;
}

/// Unpacks spans. Checks that they are separate and end with a voxel without extinction.
Dense voxels_of(const SliceSpans& slice) {
  Dense voxels(kRows * kVoxels);
  for (std::int64_t row = 0; row < kRows; ++row) {
    std::int64_t end = -1;
    for (const Span& span : slice.row(row)) {
      EXPECT_GT(span.first_block, end);
      end = span.first_block + span.blocks;
      const float* optics = slice.optics.data() + slice.place(span, span.first_block << kBlockBits);
      for (std::int64_t n = span.first_block * kBlock; n < end * kBlock; ++n, ++optics) {
        if (n % kBlock == 0 && n > span.first_block * kBlock) optics += kBlock;  // emissions
        if (n < kVoxels) {
          voxels[static_cast<std::size_t>(row * kVoxels + n)] = {optics[0], optics[kBlock]};
        } else {
          EXPECT_EQ(optics[0], 0);
        }
      }
      EXPECT_EQ(optics[-1], 0) << "its footprint would end in another block";
    }
  }
  return voxels;
}

TEST(SliceMix, WeighsEveryVoxelOfTheRequestedRows) {
  std::mt19937 random(1);
  SliceSpans mixed;
  for (int n = 0; n < 300; ++n) {
    const Dense a = random_voxels(random), b = random_voxels(random);
    const SliceSpans before = slice_of(a), behind = slice_of(b);
    const bool no_before = random() % 5 == 0, no_behind = !no_before && random() % 5 == 0;
    const float weight = static_cast<float>(random() % 100) / 100;
    const auto first = static_cast<std::int64_t>(random() % (kRows + 2)) - 1;
    const std::int64_t last = first + static_cast<std::int64_t>(random() % (kRows + 2));
    for (const SplatKernels* kernels : {&scalar_kernels(), &best_kernels()}) {
      mix_slices({no_before ? nullptr : &before, no_behind ? nullptr : &behind, weight}, first, last, {},
                 *kernels, mixed);
      const Dense voxels = voxels_of(mixed);
      for (std::int64_t row = 0; row < kRows; ++row) {
        for (std::int64_t v = 0; v < kVoxels; ++v) {
          const auto at = static_cast<std::size_t>(row * kVoxels + v);
          const bool asked = row >= first && row < last;
          for (const std::size_t plane : {0u, 1u}) {
            const float expected =
                (no_before ? 0 : (1 - weight) * a[at][plane]) + (no_behind ? 0 : weight * b[at][plane]);
            ASSERT_NEAR(voxels[at][plane], asked ? expected : 0, 1e-7) << kernels->name;
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace splatlas
