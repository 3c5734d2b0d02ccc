#include "bench/measure/isolated.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "bench/measure/frames.h"
#include "tests/support/random_scene.h"
#include "tests/support/render.h"
#include "tests/support/standard_scenes.h"

namespace splatlas {
namespace {

TEST(Isolated, HoldsOnlyWhatIsDrawn) {
  const StandardScene scene = labels_scene();
  const Selection selection = selection_of("ball:volume + core:volume", scene.content.graph);
  Selection alone;
  const auto content = isolated(scene.content, selection, alone);
  ASSERT_TRUE(content) << content.error().message;
  ASSERT_EQ(content->graph.size(), 2u);
  EXPECT_EQ(content->graph[0].id, "ball");
  EXPECT_EQ(content->graph[1].id, "core");
  ASSERT_EQ(alone.structures.size(), 2u);
  EXPECT_EQ(content->surfaces[0], scene.content.surfaces[1]);
  // A voxel has a class if it was in one of the two structures, else none.
  std::size_t held = 0;
  for (std::size_t n = 0; n < scene.content.class_volume.size(); ++n) {
    const auto members = scene.content.classes.members(scene.content.class_volume[n]);
    const bool was = std::any_of(members.begin(), members.end(),
                                 [](const Membership& member) { return member.structure > 0; });
    EXPECT_EQ(content->class_volume[n] != kEmptyClass, was);
    held += was ? 1 : 0;
  }
  EXPECT_GT(held, 0u);
}

/// Pictures of volumes and surfaces equal those of the full atlas, for overlapping, nested and crossed
/// structures.
TEST(Isolated, RendersAsInTheFullAtlas) {
  std::size_t drawn = 0;
  for (std::uint32_t number = 0; number < 60; ++number) {
    RandomScene scene = random_scene(number);
    scene.options.hybrid_shading = false;
    if (scene.selection.empty()) continue;
    Selection alone;
    const auto content = isolated(scene.content, scene.selection, alone);
    ASSERT_TRUE(content) << number << ": " << content.error().message;
    const Picture expected =
        render_or_throw(scene.content, scene.selection, scene.camera, scene.options, 1, scene.overrides);
    const Picture picture = render_or_throw(*content, alone, scene.camera, scene.options, 1, scene.overrides);
    EXPECT_EQ(bits_differ(picture.rgba, expected.rgba), 0u) << number << ": " << describe(scene);
    ++drawn;
  }
  EXPECT_GT(drawn, 30u);
}

}  // namespace
}  // namespace splatlas
