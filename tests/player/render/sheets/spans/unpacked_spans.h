// Spans as a volume.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "player/render/sheets/spans/span_model.h"
#include "tests/reference/optical_field.h"

namespace splatlas {

/// Unpacks spans into a volume, lit by `factors` (light_rows()) if any, and checks their order and blocks.
inline std::vector<reference::VoxelOptics> unpacked(const SpanModel& model, const Grid& grid,
                                                    std::span<const float> factors = {}) {
  std::vector<reference::VoxelOptics> voxels(static_cast<std::size_t>(grid.voxels()));
  const ScanOrder scan = ScanOrder::of(model.axis);
  std::uint64_t with_extinction = 0;
  for (std::size_t s = 0; s < model.slices.size(); ++s) {
    SliceSpans lit;
    const SliceSpans& slice = factors.empty() ? model.slices[s] : lit;
    for (std::int64_t row = 0; row < grid.size[scan.row_axis]; ++row) {
      if (!factors.empty()) light_rows(model.slices[s], {row, row + 1}, {}, {}, factors, lit);
      std::int64_t end_block = -1;
      for (const Span& span : slice.row(row)) {
        EXPECT_GT(span.first_block, end_block) << "else one span";
        end_block = span.first_block + span.blocks;
        std::uint32_t counted = 0;
        for (std::int64_t n = span.first_block * kBlock; n < end_block * kBlock; ++n) {
          const float* const optics = slice.optics.data() + slice.place(span, static_cast<std::uint32_t>(n));
          if (n >= grid.size[scan.scan_axis]) {
            for (std::int64_t p = 0; p < slice.block_floats(); p += kBlock) EXPECT_EQ(optics[p], 0);
            continue;
          }
          Index3 at{};
          at[scan.slice_axis] = slice.number;
          at[scan.row_axis] = row;
          at[scan.scan_axis] = n;
          reference::VoxelOptics& voxel = voxels[static_cast<std::size_t>(grid.offset(at[0], at[1], at[2]))];
          voxel.extinction = optics[0];
          for (std::size_t c = 0; c < 3; ++c) {
            voxel.emission[c] =
                model.emissions == 1 ? optics[kBlock] * model.color[c] : optics[(c + 1) * kBlock];
          }
          if (optics[0] > 0) ++counted;
        }
        EXPECT_EQ(counted, span.voxels);
        const auto last_voxel = static_cast<std::uint32_t>(end_block * kBlock - 1);
        EXPECT_EQ(slice.optics.data()[slice.place(span, last_voxel)], 0)
            << "its footprint would end in another block";
        with_extinction += counted;
      }
    }
  }
  EXPECT_EQ(with_extinction, model.voxels);
  return voxels;
}

}  // namespace splatlas
