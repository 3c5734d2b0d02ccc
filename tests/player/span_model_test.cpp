#include "player/span_model.h"

#include <cmath>

#include <gtest/gtest.h>

#include "player/shading.h"
#include "tests/reference/light_field.h"
#include "tests/support/random_scene.h"

namespace splatlas {
namespace {

/// What build_spans() takes, of a scene.
struct Prepared {
  std::shared_ptr<const Atlas> atlas;
  DrawPlan plan;
  VolumeLooks looks;
  ThreadPool pool;
  ClassCache cache;

  explicit Prepared(const RandomScene& scene, unsigned threads = 1)
      : atlas(open_in_memory(scene.content)),
        plan(atlas->tree().plan(scene.selection)),
        looks(*atlas),
        pool(threads),
        cache(atlas) {
    looks.select(plan, scene.selection);
  }

  SpanModel build(Axis axis) {
    std::vector<ClassId> classes;
    for (const ClassDraw& draw : plan.classes) {
      if (draws_volume(draw.role)) classes.push_back(draw.id);
    }
    EXPECT_TRUE(cache.require(classes, axis, pool));
    const SelectedRuns runs = *merge_runs(plan, *atlas, cache, axis);
    return build_spans(runs, plan, looks.looks(), atlas->grid(), cache, true, pool);
  }
};

/// Lays the spans out in a volume again, checks their order and blocks on the way.
std::vector<reference::VoxelLight> unpacked(const SpanModel& model, const Grid& grid) {
  std::vector<reference::VoxelLight> voxels(static_cast<std::size_t>(grid.voxels()));
  const ScanOrder scan = ScanOrder::of(model.axis);
  std::uint64_t with_extinction = 0;
  for (std::size_t s = 0; s < model.slices.size(); ++s) {
    const SliceSpans& slice = model.slices[s];
    for (std::int64_t row = 0; row < grid.size[scan.row_axis]; ++row) {
      std::int64_t end_block = -1;
      for (const Span& span : slice.row(row - model.row_first)) {
        EXPECT_GT(span.first_block, end_block) << "else one span";
        end_block = span.first_block + span.blocks;
        std::uint32_t counted = 0;
        for (std::int64_t n = span.first_block * kBlock; n < end_block * kBlock; ++n) {
          const float* const light = &slice.light[slice.place(span, static_cast<std::uint32_t>(n))];
          if (n >= grid.size[scan.scan_axis]) {
            for (std::int64_t p = 0; p < slice.block_floats(); p += kBlock) EXPECT_EQ(light[p], 0);
            continue;
          }
          Index3 at{};
          at[scan.slice_axis] = model.slice_first + static_cast<std::int64_t>(s);
          at[scan.row_axis] = row;
          at[scan.scan_axis] = n;
          reference::VoxelLight& voxel = voxels[static_cast<std::size_t>(grid.offset(at[0], at[1], at[2]))];
          voxel.extinction = light[0];
          for (std::size_t c = 0; c < 3; ++c) {
            voxel.emission[c] =
                model.emissions == 1 ? light[kBlock] * model.color[c] : light[(c + 1) * kBlock];
          }
          if (light[0] > 0) ++counted;
        }
        EXPECT_EQ(counted, span.voxels);
        const auto last_voxel = static_cast<std::uint32_t>(end_block * kBlock - 1);
        EXPECT_EQ(slice.light[slice.place(span, last_voxel)], 0)
            << "its footprint would end in another block";
        with_extinction += counted;
      }
    }
  }
  EXPECT_EQ(with_extinction, model.voxels);
  return voxels;
}

TEST(SpanModel, HoldsTheLightOfEverySelectedVoxelWithAndWithoutShading) {
  std::uint64_t compared = 0;
  for (std::uint32_t number = 0; number < 50; ++number) {
    const RandomScene scene = random_scene(number, 20);
    const ParallelView view = *parallel_view(scene.camera, scene.options.size, scene.content.display);
    Prepared prepared(scene);
    for (const Axis axis : kAxes) {
      SpanModel model = prepared.build(axis);
      for (const bool shade : {false, true, false}) {
        shade_spans(model, shade ? Lighting(view).table() : std::vector<float>(65536, 1.0f), prepared.pool);
        const reference::LightField field =
            reference::light_field(scene.content, scene.selection, view, shade);
        const std::vector<reference::VoxelLight> voxels = unpacked(model, prepared.atlas->grid());
        for (std::size_t n = 0; n < voxels.size(); ++n) {
          const double scale = field.voxels[n].extinction;
          // The float position and extinction round by 6e-8 each, the window's end to a few.
          ASSERT_NEAR(voxels[n].extinction, scale, 4e-7 * scale + 1e-38) << "scene " << number;
          for (std::size_t c = 0; c < 3; ++c) {
            ASSERT_NEAR(voxels[n].emission[c], field.voxels[n].emission[c], 2e-6 * scale + 1e-38);
          }
        }
      }
      compared += model.voxels;
    }
  }
  EXPECT_GT(compared, 20000u);
}

TEST(SpanModel, DoesNotDependOnTheNumberOfThreads) {
  const RandomScene scene = random_scene(4, 24);
  Prepared one(scene, 1);
  Prepared eight(scene, 8);
  for (const Axis axis : kAxes) {
    const SpanModel a = one.build(axis);
    const SpanModel b = eight.build(axis);
    ASSERT_EQ(a.voxels, b.voxels);
    for (std::size_t s = 0; s < a.slices.size(); ++s) {
      ASSERT_EQ(a.slices[s].light_floats(), b.slices[s].light_floats());
      for (std::size_t n = 0; n < a.slices[s].light_floats(); ++n)
        ASSERT_EQ(a.slices[s].light[n], b.slices[s].light[n]);
    }
  }
}

/// Voxels of every distance from each other, and grey values that cut runs to pieces of every length.
TEST(SpanModel, TakesNoMoreMemoryThanItSays) {
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
        const RandomScene scene{content, selection_of("a", content.graph), {}, {}};
        Prepared prepared(scene);
        const SpanModel model = prepared.build(Axis::kZ);
        std::uint64_t bytes = 0;
        for (const SliceSpans& slice : model.slices) {
          bytes += slice.light_floats() * sizeof(float) + slice.spans.size() * sizeof(Span) +
                   slice.shaded.size() * sizeof(ShadedVoxel);
        }
        EXPECT_LE(bytes, span_model_bytes(prepared.plan.volume_voxels, prepared.atlas->runs(Axis::kZ)))
            << visible << " visible, " << gap << " not";
      }
    }
  }
}

}  // namespace
}  // namespace splatlas
