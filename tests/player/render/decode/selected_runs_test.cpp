#include "player/render/decode/selected_runs.h"

#include <map>

#include <gtest/gtest.h>

#include "tests/player/prepared_selection.h"
#include "tests/support/random_scene.h"

namespace splatlas {
namespace {

/// Class index in the plan of every voxel drawn as volume, by grid offset.
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
    PreparedSelection prepared(scene.content, scene.selection);
    const auto expected = drawn_voxels(scene.content, prepared.plan);
    std::vector<ClassId> others;  // decoded but not selected
    for (ClassId c = 1; c < prepared.atlas->classes().size(); c += 2) others.push_back(c);
    const Grid& grid = prepared.atlas->grid();
    for (const Axis axis : kAxes) {
      ASSERT_TRUE(prepared.cache.require(others, axis, prepared.pool));
      const SelectedRuns runs = prepared.runs(axis);
      ASSERT_EQ(runs.axis(), axis);
      const ScanOrder scan = ScanOrder::of(axis);
      const Index3& size = grid.size;
      std::map<std::int64_t, std::uint32_t> met;
      std::size_t count = 0;
      for (std::int64_t slice = 0; slice < size[scan.slice_axis]; ++slice) {
        std::int64_t row = 0, end = 0;
        runs.for_each(slice, [&](const ClassRun& run, std::uint32_t draw) {
          ++count;
          if (run.row != row) {
            ASSERT_GT(run.row, row);
            row = run.row;
            end = 0;
          }
          ASSERT_GE(run.start, end);  // sorted and disjoint
          end = run.start + run.length;
          for (std::uint32_t n = 0; n < run.length; ++n) {
            Index3 at{};
            at[scan.slice_axis] = slice;
            at[scan.row_axis] = run.row;
            at[scan.scan_axis] = run.start + n;
            met[grid.offset(at[0], at[1], at[2])] = draw;
            ASSERT_EQ(runs.at(slice, run.row, run.start + n), &run);
            const Index3 in_scan_order{run.start + n, run.row, slice};
            for (std::size_t a = 0; a < 3; ++a) {
              ASSERT_GE(in_scan_order[a], runs.box().first[a]);
              ASSERT_LE(in_scan_order[a], runs.box().last[a]);
            }
          }
        });
      }
      ASSERT_EQ(met, expected) << "scene " << number;
      std::size_t stored = 0;
      for (const ClassId c : volume_classes(prepared.plan))
        stored += prepared.atlas->read_runs(c, axis)->size();
      ASSERT_EQ(count, stored) << "every run of a selected class, and no other";
      ASSERT_EQ(runs.count(), stored);
      for (std::int64_t n = 0; n < grid.voxels(); ++n) {
        const Index3 at{n % size[0], n / size[0] % size[1], n / size[0] / size[1]};
        const bool drawn = expected.contains(n);
        ASSERT_EQ(runs.at(at[scan.slice_axis], at[scan.row_axis], at[scan.scan_axis]) != nullptr, drawn);
      }
      for (const std::int64_t beyond : {-1, 1000}) {
        ASSERT_EQ(runs.at(beyond, 0, 0), nullptr);
        ASSERT_EQ(runs.at(0, beyond, 0), nullptr);
        ASSERT_EQ(runs.at(0, 0, beyond), nullptr);
      }
    }
  }
}

}  // namespace
}  // namespace splatlas
