#include <cmath>

#include <gtest/gtest.h>

#include "preprocess/atlas/build_atlas.h"
#include "tests/preprocess/memberships.h"
#include "tests/preprocess/random_images.h"

namespace splatlas {
namespace {

ClassifiedVoxels classify(const Masks& masks, const Grid& grid, const StructureGraph& graph) {
  return *classify_voxels(memberships_of(masks, grid.size), {}, graph, 1);
}

TEST(MeasureDisplay, TheBallReachesTheFarthestCorner) {
  Grid grid = awkward_grid(0.2);
  grid.size = {10, 10, 10};
  const Masks box{make_mask(grid.size, [](auto i, auto j, auto k) {
    return i >= 2 && i <= 5 && j >= 3 && j <= 3 && k >= 1 && k <= 8;
  })};
  const StructureGraph graph = flat_graph(1);
  const Display display = measure_display(classify(box, grid, graph), graph, {}, grid);
  const Vec3 center = index_to_lps_mm(grid).apply({3.5, 3, 4.5});
  for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(display.center_lps_mm[a], center[a], 1e-12);
  // Half of 4 x 1 x 8 voxels of 0.75 x 1.5 x 3.25 mm.
  EXPECT_NEAR(display.radius_mm, std::hypot(2 * 0.75, 0.5 * 1.5, 4 * 3.25), 1e-12);
}

TEST(MeasureDisplay, NothingAtAllFramesTheGrid) {
  const Grid grid{.size = {4, 4, 4}};
  const StructureGraph graph = flat_graph(1);
  const Display display =
      measure_display(classify({std::vector<std::uint8_t>(64, 0)}, grid, graph), graph, {}, grid);
  EXPECT_EQ(display.center_lps_mm, (Vec3{1.5, 1.5, 1.5}));
  EXPECT_NEAR(display.radius_mm, std::sqrt(12.0), 1e-12);
}

TEST(MeasureDisplay, TheWindowIsOfLabelledStructures) {
  // Values 0..999 along i; structure A has a label and holds 100..299, B has none and holds the rest.
  const Grid grid{.size = {1000, 1, 1}};
  VoxelBuffer values{VoxelType::kUInt16, std::vector<std::byte>(2000)};
  for (std::size_t v = 0; v < 1000; ++v) values.as<std::uint16_t>()[v] = static_cast<std::uint16_t>(v);
  const Masks masks{make_mask(grid.size, [](auto i, auto, auto) { return i >= 100 && i < 300; }),
                    make_mask(grid.size, [](auto i, auto, auto) { return i < 100 || i >= 300; })};
  std::vector<SourceStructure> sources(2);
  sources[0].name.push_back('A');
  sources[1].name.push_back('B');
  sources[0].label = 1;
  Notes notes;
  const StructureGraph labelled = build_graph(sources, {}, "", notes)->graph;
  Display display = measure_display(classify(masks, grid, labelled), labelled, values, grid);
  EXPECT_EQ(display.window_low, 101);   // 1 % of 200 values above 100
  EXPECT_EQ(display.window_high, 298);  // 99.5 %
  const StructureGraph bare = flat_graph(2);
  display = measure_display(classify(masks, grid, bare), bare, values, grid);
  EXPECT_EQ(display.window_low, 9);
  EXPECT_EQ(display.window_high, 994);
}

TEST(MeasureDisplay, ConstantAndBrokenValuesStillGiveAWindow) {
  const Grid grid{.size = {4, 1, 1}};
  VoxelBuffer values{VoxelType::kFloat32, std::vector<std::byte>(16)};
  const StructureGraph graph = flat_graph(1);
  const ClassifiedVoxels all = classify({std::vector<std::uint8_t>(4, 1)}, grid, graph);
  for (std::size_t v = 0; v < 4; ++v) values.as<float>()[v] = 5;
  Display display = measure_display(all, graph, values, grid);
  EXPECT_EQ(display.window_low, 5);
  EXPECT_GT(display.window_high, 5);
  for (std::size_t v = 0; v < 4; ++v) values.as<float>()[v] = v < 2 ? std::nanf("") : INFINITY;
  display = measure_display(all, graph, values, grid);
  EXPECT_LT(display.window_low, display.window_high);
}

}  // namespace
}  // namespace splatlas
