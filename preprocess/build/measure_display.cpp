#include "preprocess/build/measure_display.h"

#include <algorithm>
#include <cmath>

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
                                  const VoxelBuffer& values) {
  constexpr std::uint64_t kMaxSamples = std::uint64_t{1} << 22;
  std::uint64_t voxels = 0;
  for (ClassId c = 0; c < counts.size(); ++c) voxels += counts[c] ? classification.classes.voxels(c) : 0;
  const std::uint64_t step = std::max<std::uint64_t>(1, voxels / kMaxSamples);
  std::vector<double> samples;
  samples.reserve(voxels / step + 1);
  visit_voxel_type(values.type, [&]<typename T>(T) {
    std::uint64_t seen = 0;
    for (std::size_t v = 0; v < classification.volume.size(); ++v) {
      if (!counts[classification.volume[v]] || seen++ % step != 0) continue;
      if (const auto value = static_cast<double>(values.as<T>()[v]); std::isfinite(value))
        samples.push_back(value);
    }
  });
  return samples;
}

double percentile(std::vector<double>& samples, double percent) {
  const auto rank = static_cast<std::ptrdiff_t>(percent / 100 * static_cast<double>(samples.size() - 1));
  std::nth_element(samples.begin(), samples.begin() + rank, samples.end());
  return samples[static_cast<std::size_t>(rank)];
}

/// Calls visit(k, j, first i, last i) for every row with a voxel of a class other than the empty one.
template <typename Visit>
void visit_rows(const std::vector<ClassId>& volume, const Index3& size, Visit&& visit) {
  const ClassId* row = volume.data();
  for (std::int64_t k = 0; k < size[2]; ++k) {
    for (std::int64_t j = 0; j < size[1]; ++j, row += size[0]) {
      std::int64_t first = 0, last = size[0] - 1;
      while (first <= last && row[first] == kEmptyClass) ++first;
      while (last > first && row[last] == kEmptyClass) --last;
      if (first <= last) visit(k, j, first, last);
    }
  }
}

void measure_sphere(const std::vector<ClassId>& volume, const Grid& grid, Display& display) {
  IndexBox box;
  visit_rows(volume, grid.size, [&](std::int64_t k, std::int64_t j, std::int64_t first, std::int64_t last) {
    box.include(IndexBox{{first, j, k}, {last, j, k}});
  });
  const bool nothing = box.empty();
  if (nothing) box = {{0, 0, 0}, {grid.size[0] - 1, grid.size[1] - 1, grid.size[2] - 1}};
  Vec3 center;
  for (std::size_t a = 0; a < 3; ++a) center[a] = 0.5 * static_cast<double>(box.first[a] + box.last[a]);
  const Affine to_mm = index_to_lps_mm(grid);
  display.center_lps_mm = to_mm.apply(center);

  double farthest = 0;  // squared, mm
  const auto include_voxel = [&](std::int64_t i, std::int64_t j, std::int64_t k) {
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 from_center{static_cast<double>(i) + ((corner & 1) != 0 ? 0.5 : -0.5) - center[0],
                             static_cast<double>(j) + ((corner & 2) != 0 ? 0.5 : -0.5) - center[1],
                             static_cast<double>(k) + ((corner & 4) != 0 ? 0.5 : -0.5) - center[2]};
      const Vec3 mm = to_mm.apply_linear(from_center);
      farthest = std::max(farthest, mm[0] * mm[0] + mm[1] * mm[1] + mm[2] * mm[2]);
    }
  };
  visit_rows(volume, grid.size, [&](std::int64_t k, std::int64_t j, std::int64_t first, std::int64_t last) {
    include_voxel(first, j, k);  // a sphere is convex: the ends of a row suffice
    include_voxel(last, j, k);
  });
  if (nothing) {
    include_voxel(box.first[0], box.first[1], box.first[2]);
    include_voxel(box.last[0], box.last[1], box.last[2]);
  }
  display.radius_mm = std::sqrt(farthest);
}

}  // namespace

Display measure_display(const Classification& classification, const StructureGraph& graph,
                        const VoxelBuffer& values, const Grid& storage_grid) {
  Display display;
  measure_sphere(classification.volume, storage_grid, display);
  if (values.empty()) return display;
  std::vector<double> samples =
      sample_values(classification, classes_to_window(classification.classes, graph), values);
  if (samples.empty()) return display;
  display.window_low = percentile(samples, 1);
  display.window_high = percentile(samples, 99.5);
  if (!(display.window_high > display.window_low)) display.window_high = display.window_low + 1;
  return display;
}

}  // namespace splatlas
