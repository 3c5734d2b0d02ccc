#include "player/selected_runs.h"

#include <map>

#include <gtest/gtest.h>

#include "tests/support/random_scene.h"

namespace splatlas {
namespace {

/// The plan's class index of every voxel that the plan draws as volume, by grid offset.
std::map<std::int64_t, std::uint32_t> drawn_voxels(const AtlasContent& content, const DrawPlan& plan) {
  std::map<std::int64_t, std::uint32_t> drawn;
  for (std::size_t n = 0; n < content.class_volume.size(); ++n) {
    for (std::uint32_t d = 0; d < plan.classes.size(); ++d) {
      if (plan.classes[d].id == content.class_volume[n] && draws_volume(plan.classes[d].role)) {
        drawn[static_cast<std::int64_t>(n)] = d;
      }
    }
  }
  return drawn;
}

TEST(SelectedRuns, HoldEverySelectedVoxelOnceInScanlineOrder) {
  for (std::uint32_t number = 0; number < 80; ++number) {
    const RandomScene scene = random_scene(number, 9);
    const auto atlas = open_in_memory(scene.content);
    const DrawPlan plan = atlas->tree().plan(scene.selection);
    const auto expected = drawn_voxels(scene.content, plan);
    ThreadPool pool(1);
    ClassCache cache(atlas);
    std::vector<ClassId> classes;
    for (const ClassDraw& draw : plan.classes) {
      if (draws_volume(draw.role)) classes.push_back(draw.id);
    }
    const Grid& grid = atlas->grid();
    for (const Axis axis : kAxes) {
      ASSERT_TRUE(cache.require(classes, axis, pool));
      const SelectedRuns runs = *merge_runs(plan, *atlas, cache, axis);
      ASSERT_EQ(runs.axis, axis);
      const ScanOrder scan = ScanOrder::of(axis);
      std::map<std::int64_t, std::uint32_t> met;
      for (std::int64_t slice = runs.slice_first; slice < runs.slice_first + runs.slices; ++slice) {
        for (std::int64_t row = runs.row_first; row < runs.row_first + runs.rows; ++row) {
          std::int64_t end = runs.scan_first;
          for (const SelectedRun& run : runs.scanline(slice, row)) {
            ASSERT_GE(run.start, end);  // in order, apart, and in the box
            end = run.start + run.length;
            for (std::uint32_t n = 0; n < run.length; ++n) {
              Index3 at{};
              at[scan.slice_axis] = slice;
              at[scan.row_axis] = row;
              at[scan.scan_axis] = run.start + n;
              met[grid.offset(at[0], at[1], at[2])] = run.draw;
            }
          }
          ASSERT_LE(end, runs.scan_first + runs.scan_voxels);
        }
      }
      ASSERT_EQ(met, expected) << "scene " << number;
      std::size_t stored = 0;
      for (const ClassId c : classes) stored += atlas->read_runs(c, axis)->size();
      ASSERT_EQ(runs.runs.size(), stored) << "every run of a selected class, and no other";
    }
  }
}

}  // namespace
}  // namespace splatlas
