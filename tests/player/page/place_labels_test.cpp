// Geometry of leader lines, and order of labels.
#include "player/page/place_labels.h"

#include <gtest/gtest.h>

namespace splatlas {
namespace {

TEST(PlaceLabels, FindsIntersections) {
  EXPECT_TRUE(segments_meet({0, 0}, {10, 10}, {0, 10}, {10, 0}));
  EXPECT_TRUE(segments_meet({0, 0}, {10, 0}, {5, 0}, {5, 5}));
  EXPECT_TRUE(segments_meet({0, 0}, {10, 0}, {5, 0}, {15, 0}));
  EXPECT_FALSE(segments_meet({0, 0}, {10, 0}, {11, 0}, {15, 0}));
  EXPECT_FALSE(segments_meet({0, 0}, {10, 10}, {6, 5}, {10, 0}));
  EXPECT_TRUE(segment_meets({-5, 5}, {15, 5}, {0, 0, 10, 10}));
  EXPECT_TRUE(segment_meets({5, 5}, {6, 6}, {0, 0, 10, 10}));
  EXPECT_FALSE(segment_meets({-5, 5}, {4, 20}, {0, 0, 10, 10}));
  EXPECT_DOUBLE_EQ(distance_to_segment({5, 3}, {0, 0}, {10, 0}), 3);
  EXPECT_DOUBLE_EQ(distance_to_segment({13, 4}, {0, 0}, {10, 0}), 5);
}

TEST(PlaceLabels, ExchangesLabelsWhoseLeadersWouldCross) {
  // Two anchors of equal height on either side: in the wrong order, their leaders would cross.
  const Picture empty{{400, 400}, std::vector<float>(4 * 400 * 400)};
  const FreeSpace all_free(empty);
  const auto label = [](double x, double y) { return Label{{"x"}, 20, 10, {x, y}, 1}; };
  const std::vector<Label> labels{label(100, 200), label(101, 200), label(300, 200), label(301, 200)};
  const LabelSpace space{{0, 0, 400, 400}, 10, 2, 3, 0.01, {}};
  const std::vector<PlacedLabel> placed = place_labels(labels, space, all_free);
  ASSERT_EQ(placed.size(), 4u);
  for (std::size_t a = 0; a < 4; ++a) {
    for (std::size_t b = a + 1; b < 4; ++b) {
      EXPECT_FALSE(segments_meet(placed[a].port, labels[a].anchor, placed[b].port, labels[b].anchor));
      EXPECT_FALSE(overlap(placed[a].box, placed[b].box));
    }
  }
  EXPECT_TRUE(placed[0].is_left && placed[1].is_left);
  EXPECT_FALSE(placed[2].is_left || placed[3].is_left);
}

TEST(PlaceLabels, LeavesOutTheSmallestWhereRoomIsShort) {
  const Picture empty{{200, 100}, std::vector<float>(4 * 200 * 100)};
  const FreeSpace all_free(empty);
  std::vector<Label> labels;
  for (int n = 0; n < 40; ++n) {
    labels.push_back({{"x"}, 20, 10, {100.0 + (n % 2 ? 1 : -1) * (1 + 0.1 * n), 10.0 + 2 * n}, 1.0 + n});
  }
  const LabelSpace space{{0, 0, 200, 100}, 10, 2, 3, 0.01, {}};
  const std::vector<PlacedLabel> placed = place_labels(labels, space, all_free);
  EXPECT_GE(placed.size(), 8u);
  EXPECT_LE(placed.size(), 18u);  // 100 / (10 + 2), rounded up, on either side
  EXPECT_EQ(placed.back().label, 39u);
}

TEST(PlaceLabels, AvoidsObstacles) {
  const Picture empty{{200, 100}, std::vector<float>(4 * 200 * 100)};
  const FreeSpace all_free(empty);
  const std::vector<Label> labels{{{"x"}, 20, 10, {60, 50}, 1}};
  LabelSpace space{{0, 0, 200, 100}, 10, 2, 3, 0.1, {{0, 40, 40, 60}}};
  const std::vector<PlacedLabel> placed = place_labels(labels, space, all_free);
  ASSERT_EQ(placed.size(), 1u);
  EXPECT_FALSE(overlap(placed[0].box, space.obstacles[0]));
  space.obstacles = {{0, 0, 200, 100}};
  EXPECT_TRUE(place_labels(labels, space, all_free).empty());
}

}  // namespace
}  // namespace splatlas
