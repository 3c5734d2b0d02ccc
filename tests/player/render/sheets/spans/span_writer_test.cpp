#include "player/render/sheets/spans/span_writer.h"

#include <algorithm>
#include <array>
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

TEST(SpanWriter, ListsShadedVoxelsThatAbsorb) {
  SliceSpans slice;
  SpanWriter writer(1, slice);
  std::vector<PackedNormal> normals(200);
  for (std::size_t n = 0; n < normals.size(); ++n) normals[n] = static_cast<PackedNormal>(n);
  set(writer, 2, 3);
  set(writer, 5, 35, 0);
  set(writer, 40, 4);
  writer.shade(2, 3, {normals.data() + 10, 3, nullptr});
  writer.shade(5, 37, {normals.data() + 100, 1, nullptr});  // two of them absorb
  writer.end_row(0);
  writer.finish();
  ASSERT_EQ(slice.shaded.size(), 5u);
  const std::array<std::uint32_t, 5> voxels{2, 3, 4, 40, 41};
  const std::array<PackedNormal, 5> expected{10, 13, 16, 135, 136};
  for (std::size_t n = 0; n < 5; ++n) {
    EXPECT_EQ(slice.shaded[n].place, slice.place(slice.spans[n < 3 ? 0 : 1], voxels[n]));
    EXPECT_EQ(slice.shaded[n].normal, expected[n]);
    EXPECT_EQ(slice.shaded[n].emission[0], static_cast<float>(voxels[n]));
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
