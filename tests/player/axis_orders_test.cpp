// Invariance of pictures under all 48 axis orders of the source.
#include "tests/support/axis_orders.h"

#include <random>

#include <gtest/gtest.h>

#include "tests/support/render.h"

namespace splatlas {
namespace {

template <typename T>
std::vector<T> reordered_voxels(const std::vector<T>& voxels, const Index3& size, const AxisOrder& order) {
  std::vector<T> result(voxels.size());
  reorder_voxels(voxels.data(), size, order, sizeof(T), result.data());
  return result;
}

/// Overlapping shapes and noise in a sheared grid. All numbers are exact in binary, with any axis order.
TestVolume volume_in_storage_order() {
  TestVolume volume;
  volume.grid = {{13, 9, 11}, {1, 1.5, 0.75}, {-4, 8, 16}, {0.75, -0.25, 0, 0.5, 0.75, 0, 0, 0, 1}};
  std::mt19937 random(5);
  volume.structures = {
      {"ball", ball_mask(volume.grid.size, {4, 4, 6}, 20), {255, 60, 10}},
      {"box", box_mask(volume.grid.size, {4, 3, 0}, {12, 8, 5}), {20, 90, 255}},
      {"noise", make_mask(volume.grid.size, [&](auto...) { return random() % 7 == 0; }), {90, 255, 60}}};
  std::vector<std::int16_t> values;
  for (std::int64_t n = 0; n < volume.grid.voxels(); ++n)
    values.push_back(static_cast<std::int16_t>(random() % 500));
  volume.values = make_values(VoxelType::kInt16, values);
  volume.window_high = 500;
  return volume;
}

TEST(AxisOrders, GiveTheSamePictureBitForBit) {
  const TestVolume stored = volume_in_storage_order();
  ASSERT_TRUE(storage_order(stored.grid).is_identity());
  const AtlasContent content = make_content(stored);
  const Selection selection =
      selection_of("ball:both(opacity=0.4) + box:surface(opacity=0.5) + noise", content.graph);
  std::vector<Camera> cameras{{.azimuth_deg = 31, .elevation_deg = -22}, {}};
  for (int view = 0; view < 6; ++view) cameras.push_back(Camera::of(static_cast<NamedView>(view)));
  std::vector<Picture> expected;
  for (const Camera& camera : cameras) {
    expected.push_back(render_or_throw(content, selection, camera, {.size = {48, 40}}));
  }

  const std::vector<AxisOrder> orders = all_axis_orders();
  ASSERT_EQ(orders.size(), 48u);
  for (const AxisOrder& order : orders) {
    TestVolume source = stored;
    source.grid = reordered(stored.grid, order);
    for (TestStructure& structure : source.structures) {
      const std::vector<std::uint8_t> mask(structure.mask.begin(), structure.mask.end());
      const auto moved = reordered_voxels(mask, stored.grid.size, order);
      structure.mask.assign(moved.begin(), moved.end());
    }
    const auto* values = stored.values.as<std::int16_t>();
    source.values = make_values(
        VoxelType::kInt16, reordered_voxels(std::vector<std::int16_t>(values, values + stored.grid.voxels()),
                                            stored.grid.size, order));
    const AtlasContent reordered_content = make_content(source);
    EXPECT_EQ(reordered_content.class_volume, content.class_volume);
    Renderer renderer = renderer_of(reordered_content, selection);
    for (std::size_t n = 0; n < cameras.size(); ++n) {
      ASSERT_EQ(render_or_throw(renderer, cameras[n], {.size = {48, 40}}).rgba, expected[n].rgba)
          << "order " << +order.from[0] << +order.from[1] << +order.from[2] << " flipped " << order.flipped[0]
          << order.flipped[1] << order.flipped[2] << ", camera " << n;
    }
  }
}

}  // namespace
}  // namespace splatlas
