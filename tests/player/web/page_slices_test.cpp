#include "player/web/page_slices.h"

#include <gtest/gtest.h>

#include "tests/support/test_content.h"

namespace splatlas {
namespace {

/// Two boxes that overlap, in a grid of different sides; the grey value of a voxel is its number.
TEST(PageSlices, HoldTheLastStructureAndTheGreyValue) {
  TestVolume volume;
  const Index3 size = volume.grid.size = {4, 3, 5};
  volume.structures = {{"first", box_mask(size, {0, 0, 0}, {2, 1, 4})},
                       {"second", box_mask(size, {1, 1, 1}, {3, 2, 3})}};
  volume.values.type = VoxelType::kUInt8;
  for (int n = 0; n < 60; ++n) volume.values.bytes.push_back(std::byte(n));
  volume.window_high = 51;  // 5 a grey value
  PageSlices slices(open_in_memory(make_content(volume)));
  const auto holds = [&](std::size_t s, std::int64_t n) {
    return volume.structures[s].mask[static_cast<std::size_t>(n)];
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t along = axis == 0 ? 1 : 0, across = axis == 2 ? 1 : 2;
    for (std::int64_t index = 0; index < size[axis]; ++index) {
      const auto slice = *slices.slice(static_cast<int>(axis), index);
      std::vector<std::int64_t> labels;
      for (std::size_t run = 0; run < slice.at("labels").size(); run += 2)
        labels.resize(labels.size() + slice.at("labels")[run + 1].get<std::size_t>(),
                      slice.at("labels")[run].get<std::int64_t>());
      ASSERT_EQ(labels.size(), static_cast<std::size_t>(size[along] * size[across]));
      const auto& greys = slice.at("greys").get_ref<const std::string&>();
      std::size_t place = 0;
      Index3 at{};
      at[axis] = index;
      for (at[across] = 0; at[across] < size[across]; ++at[across]) {
        for (at[along] = 0; at[along] < size[along]; ++at[along], ++place) {
          const std::int64_t n = (at[2] * size[1] + at[1]) * size[0] + at[0];
          EXPECT_EQ(labels[place], holds(1, n) ? 2 : holds(0, n) ? 1 : 0) << axis << ": " << place;
          const std::int64_t grey = labels[place] == 0 ? 0 : std::min<std::int64_t>(5 * n, 255);
          EXPECT_EQ(std::stol(greys.substr(2 * place, 2), nullptr, 16), grey);
        }
      }
    }
    EXPECT_EQ(slices.slice(static_cast<int>(axis), size[axis]).error().code, ErrorCode::kNotFound);
  }
  EXPECT_EQ(slices.slice(3, 0).error().code, ErrorCode::kNotFound);
}

}  // namespace
}  // namespace splatlas
