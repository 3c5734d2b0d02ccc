#include "preprocess/atlas/measure_display.h"

#include <algorithm>
#include <cmath>

#include "format/derive/value_groups.h"

namespace splatlas {
namespace {

/// [class]: true if its grey values contribute to the window.
std::vector<bool> classes_to_window(const ClassTable& classes, const StructureGraph& graph) {
  const bool any_label = std::any_of(graph.structures().begin(), graph.structures().end(),
                                     [](const Structure& s) { return s.label.has_value(); });
  std::vector<bool> counts(classes.size(), false);
  for (ClassId c = 0; c < classes.size(); ++c) {
    for (const Membership& m : classes.members(c)) {
      if (m.holds() && (!any_label || graph[m.structure].label)) counts[c] = true;
    }
  }
  return counts;
}

/// Finite grey values of the contributing classes, subsampled regularly if there are many.
std::vector<double> sample_values(const Classification& classification, const std::vector<bool>& counts,
                                  const VoxelBuffer& values, std::uint64_t width) {
  constexpr std::uint64_t kMaxSamples = std::uint64_t{1} << 22;
  std::uint64_t voxels = 0;
  for (ClassId c = 0; c < counts.size(); ++c) voxels += counts[c] ? classification.classes.voxels(c) : 0;
  const std::uint64_t step = std::max<std::uint64_t>(1, voxels / kMaxSamples);
  std::vector<ClassId> ids;
  std::vector<ClassRuns> runs;
  for (ClassId c = 0; c < counts.size(); ++c) {
    if (!counts[c]) continue;
    ids.push_back(c);
    runs.push_back(classification.runs.classes[c]);
  }
  std::vector<double> samples;
  samples.reserve(voxels / step + 1);
  visit_voxel_type(values.type, [&]<typename T>(T) {
    std::uint64_t next = 0;  // voxels until the next sample
    for (const auto& [run, id] : merge_runs(ids, runs)) {
      const T* const first = values.as<T>() + run.scanline * width + run.start;
      for (; next < run.length; next += step) {
        if (const auto value = static_cast<double>(first[next]); std::isfinite(value))
          samples.push_back(value);
      }
      next -= run.length;
    }
  });
  return samples;
}

double percentile(std::vector<double>& samples, double percent) {
  const auto rank = static_cast<std::ptrdiff_t>(percent / 100 * static_cast<double>(samples.size() - 1));
  std::nth_element(samples.begin(), samples.begin() + rank, samples.end());
  return samples[static_cast<std::size_t>(rank)];
}

/// First and last voxels of the rows with a voxel of a class other than the empty one.
std::vector<IndexBox> ends_of_rows(const RunModel& runs, const Index3& size) {
  std::vector<IndexBox> rows(static_cast<std::size_t>(size[1] * size[2]));
  for (const ClassRuns& of_class : runs.classes) {
    for (const Run& run : of_class) {
      const auto scanline = static_cast<std::int64_t>(run.scanline);
      const std::int64_t j = scanline % size[1], k = scanline / size[1];
      rows[run.scanline].include(
          IndexBox{{run.start, j, k}, {std::int64_t{run.start} + run.length - 1, j, k}});
    }
  }
  std::erase_if(rows, [](const IndexBox& row) { return row.empty(); });
  return rows;
}

void measure_sphere(const RunModel& runs, const Grid& grid, Display& display) {
  const std::vector<IndexBox> rows = ends_of_rows(runs, grid.size);
  IndexBox box;
  for (const IndexBox& row : rows) box.include(row);
  const bool nothing = box.empty();
  if (nothing) box = {{0, 0, 0}, {grid.size[0] - 1, grid.size[1] - 1, grid.size[2] - 1}};
  Vec3 center;
  for (std::size_t a = 0; a < 3; ++a) center[a] = 0.5 * static_cast<double>(box.first[a] + box.last[a]);
  const Affine to_mm = index_to_lps_mm(grid);
  display.center_lps_mm = to_mm.apply(center);

  double farthest = 0;  // squared, mm
  const auto include_voxel = [&](const Index3& at) {
    for (unsigned corner = 0; corner < 8; ++corner) {
      Vec3 from_center;
      for (std::size_t a = 0; a < 3; ++a)
        from_center[a] = static_cast<double>(at[a]) + ((corner >> a & 1u) != 0 ? 0.5 : -0.5) - center[a];
      const Vec3 mm = to_mm.apply_linear(from_center);
      farthest = std::max(farthest, mm[0] * mm[0] + mm[1] * mm[1] + mm[2] * mm[2]);
    }
  };
  for (const IndexBox& row : nothing ? std::vector{box} : rows) {
    include_voxel(row.first);  // a sphere is convex: the ends of a row suffice
    include_voxel(row.last);
  }
  display.radius_mm = std::sqrt(farthest);
}

}  // namespace

Display measure_display(const Classification& classification, const StructureGraph& graph,
                        const VoxelBuffer& values, const Grid& storage_grid) {
  Display display;
  measure_sphere(classification.runs, storage_grid, display);
  if (values.empty()) return display;
  std::vector<double> samples =
      sample_values(classification, classes_to_window(classification.classes, graph), values,
                    static_cast<std::uint64_t>(storage_grid.size[0]));
  if (samples.empty()) return display;
  display.window_low = percentile(samples, 1);
  display.window_high = percentile(samples, 99.5);
  if (!(display.window_high > display.window_low)) display.window_high = display.window_low + 1;
  return display;
}

}  // namespace splatlas
