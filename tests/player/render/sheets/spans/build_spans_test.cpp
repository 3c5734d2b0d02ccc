#include "player/render/sheets/spans/build_spans.h"

#include <gtest/gtest.h>

#include "player/render/transfer/shading.h"
#include "tests/player/prepared_selection.h"
#include "tests/player/render/sheets/spans/unpacked_spans.h"
#include "tests/reference/optical_field.h"
#include "tests/support/random_scene.h"

namespace splatlas {
namespace {

TEST(BuildSpans, HoldsTheLightOfEverySelectedVoxelWithAndWithoutShading) {
  std::uint64_t compared = 0, other_codes = 0;
  for (std::uint32_t number = 0; number < 50; ++number) {
    const RandomScene scene = random_scene(number, 20);
    const ParallelView view = *parallel_view(scene.camera, scene.options.size, scene.content.display);
    PreparedSelection prepared(scene.content, scene.selection);
    for (const Axis axis : kAxes) {
      const SpanModel model = prepared.spans(axis);
      for (const bool shade : {false, true}) {
        const std::vector<float> factors = shade ? Lighting(view).table() : std::vector<float>();
        const reference::OpticalField field =
            reference::optical_field(scene.content, scene.selection, view, shade);
        ASSERT_NEAR(model.mean_densest_per_mm, field.mean_densest, 1e-6 * field.mean_densest);
        const std::vector<reference::VoxelOptics> voxels = unpacked(model, prepared.atlas->grid(), factors);
        for (std::size_t n = 0; n < voxels.size(); ++n) {
          const double scale = field.voxels[n].extinction;
          // The float position and extinction round by 6e-8 each, the end of the window by a few.
          ASSERT_NEAR(voxels[n].extinction, scale, 4e-7 * scale + 1e-38) << "scene " << number;
          for (std::size_t c = 0; c < 3; ++c) {
            const double error = std::abs(voxels[n].emission[c] - field.voxels[n].emission[c]);
            // Lit shares of 16 bits round by 8e-6; a normal halfway between two codes may take the other one.
            const double one_code = 0.01;
            ASSERT_LE(error, (shade ? one_code : 2e-6) * scale + 1e-38) << "scene " << number;
            if (error > 1e-5 * scale + 1e-38) ++other_codes;
          }
        }
      }
      compared += model.voxels;
    }
  }
  EXPECT_GT(compared, 20000u);
  EXPECT_LT(other_codes, compared / 1000);
}

/// Voxels at every distance, and grey values that cut runs into pieces of every length.
TEST(BuildSpans, TakesNoMoreMemoryThanItSays) {
  for (const std::int64_t visible : {1, 2, 7, 8, 15, 16, 17, 31, 32, 33}) {
    for (const std::int64_t gap : {1, 7, 8, 9, 10, 16, 17}) {
      for (const bool by_value : {false, true}) {
        TestVolume volume;
        volume.grid.size = {150, 1, 2};
        const auto mask =
            make_mask(volume.grid.size, [&](auto i, auto, auto) { return i % (visible + gap) < visible; });
        volume.structures = {{"a", by_value ? std::vector<bool>(mask.size(), true) : mask}};
        volume.values = make_values(VoxelType::kUInt8, std::vector<std::uint8_t>(mask.begin(), mask.end()));
        const AtlasContent content = make_content(volume);
        PreparedSelection prepared(content, selection_of("a", content.graph));
        const SpanModel model = prepared.spans(Axis::kZ);
        std::uint64_t bytes = 0;
        for (const SliceSpans& slice : model.slices) {
          bytes += slice.optics.size() * sizeof(float) + slice.spans.size() * sizeof(Span) +
                   slice.lights.size() * sizeof(BlockLights);
        }
        EXPECT_LE(bytes, span_model_bytes(prepared.plan.volume_voxels, prepared.atlas->runs(Axis::kZ)))
            << visible << " visible, " << gap << " not";
      }
    }
  }
}

/// Boxes in a row along z, the last one in two halves along y: only rows that change are rebuilt.
TEST(BuildSpans, OnlyRowsThatChangeAreBuilt) {
  TestVolume volume;
  volume.grid.size = {20, 20, 30};
  const auto add = [&](const char* name, const Index3& first, const Index3& last) {
    volume.structures.push_back({name, box_mask(volume.grid.size, first, last)});
  };
  add("a", {3, 3, 0}, {16, 16, 9});
  add("b", {3, 3, 10}, {16, 16, 19});
  add("c", {3, 3, 20}, {16, 8, 29});
  add("d", {3, 9, 20}, {16, 16, 29});
  const AtlasContent content = make_content(volume);
  PreparedSelection prepared(content, selection_of("*:volume(color=#ffffff)", content.graph));
  SpanBuilder builder;
  const auto built_for = [&](const std::string& text) {
    prepared.select(selection_of(text, content.graph));
    prepared.build(Axis::kZ, builder);
    return builder.rows_built();
  };
  EXPECT_EQ(built_for("*:volume(color=#ffffff)"), 30 * 20);
  EXPECT_EQ(built_for("*:volume(color=#ffffff)"), 0);
  EXPECT_EQ(built_for("*:volume(color=#ffff00)"), 0) << "the colour of all is no voxel's";
  EXPECT_EQ(built_for("*:volume(color=#ffff00) - b"), 10 * 14);
  EXPECT_EQ(built_for("a:volume(color=#ffff00)"), 0);
  EXPECT_EQ(built_for("*:volume(color=#ffff00)"), 20 * 14);
  EXPECT_EQ(built_for("*:volume(color=#ffff00) + c:volume(color=#ffff00,opacity=0.5)"), 10 * 6);
  EXPECT_EQ(built_for("*:volume(color=#ffff00) - d"), 10 * 14) << "c, and most rows";
  EXPECT_EQ(built_for("*:volume(color=#ffff00) + c:volume(color=#ff0000)"), 30 * 20) << "three emissions";
}

}  // namespace
}  // namespace splatlas
