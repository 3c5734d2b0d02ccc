#include "player/render/surfaces/tile_layers.h"

#include <map>
#include <random>
#include <tuple>

#include <gtest/gtest.h>

#include "tests/support/render.h"

namespace splatlas {
namespace {

/// A tile of one slot in front of two translucent surfaces of one structure each.
class TileLayersTest : public testing::Test {
 protected:
  void pass(double depth, std::uint32_t side, std::uint32_t slot = 0) {
    layers_.add() = {.depth = depth, .slot = slot, .side = side, .normal_lps = {0, -1, 0}};
  }
  /// Structures of the fragments, front to back.
  [[nodiscard]] std::vector<StructureIndex> order() const {
    std::vector<StructureIndex> structures;
    for (const SlotFragment& of : layers_.fragments()) structures.push_back(of.fragment.structure);
    return structures;
  }

  ParallelView view_ = *parallel_view({}, {1, 1}, Display{});
  Grid grid_{{9, 9, 9}, {1, 1, 1}, {0, 0, 0}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
  Lighting lighting_{view_};
  std::array<SurfaceDraw, 2> surfaces_{SurfaceDraw{.structure = 0, .opacity = 0.5f},
                                       SurfaceDraw{.structure = 1, .opacity = 0.5f}};
  RasterScene scene_ = raster_scene(surfaces_, view_, factorise(view_, grid_), grid_, lighting_);
  TileLayers layers_;
};

constexpr double kBin = 1 / 4096.0;

TEST_F(TileLayersTest, KeepBinsTogether) {
  // A front face just in front of a back face in the same bin: the back face precedes it
  for (int n = -8; n <= 8; ++n) {
    layers_.begin(scene_, PixelBox::of({1, 1}), 1, {.keeps_fragments = true});
    const double first = (5 - 0.3183 + 0.2) * kBin, second = first + 0.6 * kBin;
    pass(first, 1);
    pass(second, 2);
    static_cast<void>(layers_.pass(static_cast<float>(first + 0.3 * n * kBin)));
    static_cast<void>(layers_.pass(HUGE_VALF));
    EXPECT_EQ(order(), (std::vector<StructureIndex>{1, 0})) << n;
  }
}

TEST_F(TileLayersTest, CompositeFrontToBackWhileCrossingsArrive) {
  // Clusters, near ones first, that overlap in depth and share bins
  constexpr std::uint32_t kSlots = 16;
  for (SurfaceDraw& surface : surfaces_) surface.opacity = 0.0001f;
  layers_.begin(scene_, PixelBox::of({1, 1}), kSlots, {.keeps_fragments = true});
  std::mt19937 random(3);
  using Key = std::tuple<double, std::uint32_t, std::uint32_t>;  // bin, front or back, surface
  std::vector<std::map<Key, float>> expected(kSlots);
  std::size_t passes = 0;
  for (int cluster = 0; cluster < 1000; ++cluster) {
    const double nearest = cluster * 0.01;
    passes += layers_.is_due() ? 1 : 0;
    if (layers_.is_due()) static_cast<void>(layers_.pass(static_cast<float>(nearest)));
    for (int n = 0; n < 64; ++n) {
      const double depth = nearest + static_cast<double>(random() % 4000) * 0.25 * kBin;
      const auto side = static_cast<std::uint32_t>(random() % 4),
                 slot = static_cast<std::uint32_t>(random() % kSlots);
      const Key key{std::floor(depth / kBin + 0.3183), side % 2, side / 2};
      if (expected[slot].emplace(key, static_cast<float>(depth)).second) pass(depth, side, slot);
    }
  }
  static_cast<void>(layers_.pass(HUGE_VALF));
  EXPECT_GT(passes, 5u);
  std::vector<std::vector<float>> depths(kSlots);
  for (const SlotFragment& of : layers_.fragments()) depths[of.slot].push_back(of.fragment.depth);
  for (std::uint32_t slot = 0; slot < kSlots; ++slot) {
    std::vector<float> sorted;
    for (const auto& [key, depth] : expected[slot]) sorted.push_back(depth);
    EXPECT_EQ(depths[slot], sorted);
  }
}

TEST_F(TileLayersTest, EndSlotsAtTheThreshold) {
  layers_.begin(scene_, PixelBox::of({1, 1}), 1, {.termination_threshold = 0.25f, .keeps_fragments = true});
  for (int n = 0; n < 4; ++n) pass(n, 1);
  EXPECT_EQ(layers_.pass(HUGE_VALF).size(), 1u);
  EXPECT_EQ(order().size(), 2u);  // 0.5 * 0.5 is at the threshold
  EXPECT_FLOAT_EQ(layers_.radiance(0).rgba[3], 0.75f);
  EXPECT_FALSE(layers_.is_clear(0));
}

}  // namespace
}  // namespace splatlas
