// Id images of the renderer: validity and closed forms. Random scenes compare them with brute force.

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
      const Frame frame = frame_or_throw(renderer, camera, options);
      const IdImage& ids = frame.ids;
      ASSERT_EQ(ids.size, options.size);
      EXPECT_EQ(ids.at(10, 8), 0u);
      EXPECT_EQ(ids.at(22, 8), 1u);
      EXPECT_EQ(ids.at(0, 0), kNoStructure);
      const std::optional<Pick> pick = frame.pick(22.5, 8.5);
      ASSERT_TRUE(pick);
      EXPECT_EQ(pick->structure, 1u);
    }
  }
}

/// The renderer reuses the memory of a frame: nothing of an earlier id image remains.
TEST(IdImages, AreEmptyUnlessAskedFor) {
  const AtlasContent content = two_boxes();
  Renderer renderer = renderer_of(content, all_as(content, DrawMode::kVolume));
  Frame frame;
  ASSERT_TRUE(renderer.render({}, {.size = {32, 16}, .ids = true}, frame));
  const std::vector<StructureNumber> first = frame.ids.numbers;
  EXPECT_FALSE(first.empty());
  ASSERT_TRUE(renderer.render({}, {.size = {32, 16}}, frame));
  EXPECT_TRUE(frame.ids.empty());
  ASSERT_TRUE(renderer.render({}, {.size = {32, 16}, .ids = true}, frame));
  EXPECT_EQ(frame.ids.numbers, first);
}

}  // namespace
}  // namespace splatlas
