// Id images of the renderer: validity and closed forms. Random scenes compare them with brute force.

#include <stop_token>

#include <gtest/gtest.h>

#include "tests/support/render.h"
#include "tests/support/test_content.h"

namespace splatlas {
namespace {

/// Two boxes side by side: the first one to the right of the second one.
AtlasContent two_boxes() {
  TestVolume volume;
  volume.grid.size = {16, 8, 8};
  volume.structures = {{"first", box_mask(volume.grid.size, {1, 1, 1}, {7, 6, 6})},
                       {"second", box_mask(volume.grid.size, {8, 1, 1}, {14, 6, 6})}};
  return make_content(volume);
}

Selection all_as(const AtlasContent& content, DrawMode mode) {
  Selection selection;
  selection.structures.resize(content.graph.size());
  for (StructureDraw& draw : selection.structures) {
    draw.mode = mode;
    draw.opacity = 0.9f;
  }
  return selection;
}

/// From the front, the subject's right is on the left of the picture: the first box is there.
TEST(IdImages, ShowTheNearestOfTwoBoxes) {
  const AtlasContent content = two_boxes();
  for (const DrawMode mode : {DrawMode::kVolume, DrawMode::kSurface, DrawMode::kBoth}) {
    for (const CameraProjection projection : {CameraProjection::kParallel, CameraProjection::kPerspective}) {
      Renderer renderer = renderer_of(content, all_as(content, mode));
      Camera camera = Camera::of(NamedView::kAnterior);
      camera.projection = projection;
      const RenderOptions options{.size = {32, 16}, .ids = true};
      ASSERT_TRUE(renderer.render(camera, options));
      const IdImage& ids = renderer.ids();
      ASSERT_EQ(ids.size, options.size);
      EXPECT_EQ(ids.at(10, 8), 0u);
      EXPECT_EQ(ids.at(22, 8), 1u);
      EXPECT_EQ(ids.at(0, 0), kNoStructure);
      const std::optional<Pick> pick = renderer.pick(22.5, 8.5);
      ASSERT_TRUE(pick);
      EXPECT_EQ(pick->structure, 1u);
    }
  }
}

TEST(IdImages, BelongToTheLatestFinishedPicture) {
  const AtlasContent content = two_boxes();
  Renderer renderer = renderer_of(content, all_as(content, DrawMode::kVolume));
  EXPECT_TRUE(renderer.ids().empty());
  const RenderOptions with_ids{.size = {32, 16}, .ids = true};
  ASSERT_TRUE(renderer.render({}, with_ids));
  const std::vector<StructureNumber> first = renderer.ids().numbers;
  EXPECT_FALSE(first.empty());

  std::stop_source stop;
  stop.request_stop();
  Camera other;
  other.zoom = 3;
  EXPECT_FALSE(renderer.render(other, with_ids, {.stop = stop.get_token()}));
  EXPECT_EQ(renderer.ids().numbers, first);
  ASSERT_TRUE(renderer.render(other, {.size = {32, 16}}));
  EXPECT_TRUE(renderer.ids().empty());
  ASSERT_TRUE(renderer.render({}, with_ids));
  EXPECT_EQ(renderer.ids().numbers, first);
  ASSERT_TRUE(renderer.select(all_as(content, DrawMode::kSurface)));
  EXPECT_TRUE(renderer.ids().empty());
}

}  // namespace
}  // namespace splatlas
