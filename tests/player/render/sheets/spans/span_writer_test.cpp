#include "player/render/sheets/spans/span_writer.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

namespace splatlas {
namespace {

/// Sets voxels to extinction 1 and emission `place`.
void set(SpanWriter& writer, std::uint32_t first, std::uint32_t count, float extinction = 1) {
  writer.add(first, count);
  for (std::uint32_t n = first; n < first + count; ++n) {
    *writer.extinctions(n) = extinction;
    *writer.emissions(n, 0) = extinction * static_cast<float>(n);
  }
}

/// First block, number of blocks, voxels and offset of every span.
std::vector<std::array<std::uint32_t, 4>> layout(const SliceSpans& slice) {
  std::vector<std::array<std::uint32_t, 4>> spans;
  for (const Span& span : slice.spans)
    spans.push_back({span.first_block, span.blocks, span.voxels, span.offset});
  return spans;
}
using Layout = std::vector<std::array<std::uint32_t, 4>>;

TEST(SpanWriter, KeepsTheBlocksThatAbsorb) {
  SliceSpans slice;
  SpanWriter writer(1, slice);
  set(writer, 5, 3);        // block 0
  set(writer, 8, 7, 0);     // nothing
  set(writer, 33, 30);      // blocks 2 and 3, up to the last but one voxel
  set(writer, 63, 1);       // the last voxel: reaches block 4
  set(writer, 80, 2);       // block 5, adjacent to that
  set(writer, 112, 32, 0);  // no extinction in two blocks
  set(writer, 204, 1);      // block 12
  writer.end_row(7);
  writer.end_row(8);
  set(writer, 5, 1);
  writer.end_row(9);
  writer.finish();
  EXPECT_EQ(layout(slice), (Layout{{0, 1, 3, 0}, {2, 4, 33, 1}, {12, 1, 1, 5}, {0, 1, 1, 6}}));
  EXPECT_EQ(slice.voxels, 38u);
  EXPECT_EQ(slice.first_row, 7);
  EXPECT_EQ(slice.last_row, 10);
  EXPECT_EQ(slice.first_span, (std::vector<std::uint32_t>{0, 3, 3, 4}));
  EXPECT_EQ(slice.row(6).size(), 0u);
  EXPECT_EQ(slice.row(7).size(), 3u);
  EXPECT_EQ(slice.row(8).size(), 0u);
  EXPECT_EQ(slice.row(9).size(), 1u);
  EXPECT_EQ(slice.row(10).size(), 0u);
  ASSERT_EQ(slice.optics.size(), 7u * 32);
  for (std::uint32_t n = 0; n < 80; ++n) {  // of the second span
    const std::uint32_t voxel = 32 + n;
    if (voxel >= 96) break;
    const float* const optics = slice.optics.data() + slice.place(slice.spans[1], voxel);
    const bool lit = (voxel > 32 && voxel < 64) || voxel == 80 || voxel == 81;
    EXPECT_EQ(optics[0], lit ? 1.0f : 0.0f) << voxel;
    EXPECT_EQ(optics[kBlock], lit ? static_cast<float>(voxel) : 0.0f) << voxel;
  }
}

/// A footprint beyond the last block gets an empty block, even outside the scanline.
TEST(SpanWriter, SpansEndInTheDark) {
  SliceSpans slice;
  SpanWriter writer(3, slice);
  writer.add(16, 16);
  std::fill_n(writer.extinctions(16), 16, 2.0f);
  writer.end_row(0);
  writer.finish();
  EXPECT_EQ(layout(slice), (Layout{{1, 2, 16, 0}}));
  ASSERT_EQ(slice.optics.size(), 2u * 64);
  EXPECT_TRUE(
      std::all_of(slice.optics.data() + 64, slice.optics.data() + 128, [](float f) { return f == 0; }));
}

/// Runs end at gaps and where the colour changes, and pass over the borders of blocks.
TEST(SpanWriter, ListsRunsOfLitVoxelsThatAbsorb) {
  SliceSpans slice;
  SpanWriter writer(3, slice);
  std::vector<PackedNormal> normals(200);
  std::iota(normals.begin(), normals.end(), PackedNormal{0});
  const std::vector<std::uint16_t> lit{LitVoxel::kAllLit, 0, LitVoxel::kAllLit / 3};
  writer.add(2, 42);
  for (std::uint32_t n = 2; n < 44; ++n) {
    *writer.extinctions(n) = n < 5 || n >= 30 ? 1 : 0;
    *writer.whites(n) = *writer.extinctions(n) * static_cast<float>(n);
  }
  writer.color(2, 3, {1, 2, 4}, {normals.data() + 10, 1, lit.data()});
  writer.color(5, 27, {8, 16, 32}, {normals.data() + 100, 3, nullptr});  // two of them absorb
  writer.color(32, 12, {3, 3, 3}, {normals.data(), 0, nullptr});
  writer.end_row(0);
  writer.finish();

  for (const LitRun& run : slice.lit.runs)
    light_run(run, run.number, run.end(), std::vector<float>(200, 0.5f), slice);
  const auto lane = [&](std::uint32_t voxel) { return SliceSpans::lane_of(slice.spans[0], voxel); };
  EXPECT_EQ(slice.lit.runs.size(), 4u);  // from voxels 2, 4, 30 and 32 on
  ASSERT_EQ(slice.lit.voxels.size(), 16u);
  EXPECT_EQ(slice.lit.voxels[1].normal, 12);
  EXPECT_EQ(slice.lit.voxels[3].normal, 178);
  LitCursor cursor(slice.lit);
  for (const std::uint32_t n : {2, 3, 4, 30, 31, 32, 43}) {
    const float* const optics = slice.optics.data() + slice.place(lane(n));
    const float blue = n < 5    ? 4.0f
                       : n < 32 ? 32.0f
                                : 3.0f,
                factor = n == 3   ? 1.0f
                         : n == 4 ? 5.0f / 6
                                  : 0.5f;
    EXPECT_EQ(cursor.find(lane(n)) == nullptr, n == 3);
    EXPECT_FLOAT_EQ(optics[3 * kBlock], static_cast<float>(n) * blue * factor) << n;
  }
}

TEST(SpanWriter, ASliceIsWrittenAnew) {
  SliceSpans slice;
  const auto write = [&](std::uint32_t voxels) {
    SpanWriter writer(1, slice);
    if (voxels > 0) set(writer, 0, voxels);
    writer.end_row(3);
    writer.finish();
  };
  write(60);
  const std::size_t capacity = slice.optics.capacity();
  const float* const memory = slice.optics.data();
  write(10);
  EXPECT_EQ(layout(slice), (Layout{{0, 1, 10, 0}}));
  EXPECT_EQ(slice.optics.capacity(), capacity);
  EXPECT_EQ(slice.optics.data(), memory);
  write(0);
  EXPECT_TRUE(slice.spans.empty() && slice.first_span.empty());
  EXPECT_EQ(slice.first_row, slice.last_row);
  EXPECT_EQ(slice.voxels, 0u);
}

}  // namespace
}  // namespace splatlas
