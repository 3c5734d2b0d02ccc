#include "bench/experiments/packed_spans.h"

#include <array>

#include <gtest/gtest.h>

#include "bench/measure/frames.h"
#include "player/render/sheets/spans/build_spans.h"
#include "tests/support/standard_scenes.h"

namespace splatlas {
namespace {

/// Voxels with extinction, and sums of all planes.
struct Sums {
  std::uint64_t voxels = 0;
  std::array<double, 4> planes{};
};

Sums sums_of(const SpanModel& model) {
  Sums sums;
  for (const SliceSpans& slice : model.slices) {
    for (std::size_t n = 0; n < slice.optics.size(); ++n) {
      const std::size_t plane =
          n / static_cast<std::size_t>(kBlock) % static_cast<std::size_t>(1 + slice.emissions);
      sums.planes[plane] += slice.optics.data()[n];
      if (plane == 0 && slice.optics.data()[n] > 0) ++sums.voxels;
    }
  }
  return sums;
}

TEST(PackSpans, HoldsAllVoxelsInFullRows) {
  ThreadPool pool(1);
  for (const auto& [scene, parts] : {std::pair(phantom_scene(), 1), {labels_scene(), 3}}) {
    const auto atlas = open_in_memory(scene.content);
    for (const Axis axis : kAxes) {
      const auto decoded = decode_volumes(atlas, scene.selection, axis, pool);
      ASSERT_TRUE(decoded);
      SpanBuilder builder;
      builder.build({*decoded->runs, decoded->plan, *decoded->appearances, atlas->classes(), atlas->grid(),
                     *decoded->cache, false},
                    pool);
      const SpanModel& model = builder.model();
      Shear shear;
      shear.principal = axis;
      const SheetWindow window{{.scale = 2, .parts = parts}, -3, -2, 45, 37};
      const PackedSpans packed = pack_spans(model, shear, window);
      EXPECT_EQ(packed.window.columns, window.columns);
      EXPECT_EQ(packed.window.scale, window.scale);
      const Sums before = sums_of(model), after = sums_of(packed.model);
      EXPECT_EQ(packed.model.voxels, model.voxels);
      EXPECT_EQ(after.voxels, before.voxels);
      for (std::size_t plane = 0; plane < 4; ++plane)
        EXPECT_NEAR(after.planes[plane], before.planes[plane], 1e-4 * (1 + before.planes[plane]));
      for (std::size_t n = 0; n + 1 < packed.model.slices.size(); ++n)
        EXPECT_EQ(packed.model.slices[n].voxels, 36u * 31u);  // 45 columns hold two blocks, less one voxel

      // They lie within the sheet: all of them are composited.
      SheetImage sheet;
      FragmentOrder order;
      FragmentList none;
      none.first_of_row.assign(9, 0);
      order.build(none, packed.shear, packed.window, {8, 8}, atlas->grid(), pool);
      EXPECT_EQ(
          render_sheets(packed.model, packed.shear, packed.window, best_kernels(), 0, {}, order, sheet, pool),
          model.voxels);
      const auto lit = std::count_if(sheet.pixels.begin(), sheet.pixels.end(), [](float f) { return f > 0; });
      EXPECT_GT(lit, 36 * 31) << "pixels of the slices, fully covered";
    }
  }
}

}  // namespace
}  // namespace splatlas
