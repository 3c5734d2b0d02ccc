#include "player/render/light/voxel_light.h"

#include <limits>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "format/content/voxel_type.h"
#include "format/tasks/task_control.h"

namespace splatlas {
namespace {

/// How a class is lit.
struct ClassLight {
  std::int32_t group = 0;  // of its structures; 0: none of the group is lit anew
  bool boundary = false;
  bool anew = false;
  const TransferTable* transfer = nullptr;
};

/// What all slices share.
struct LightScene {
  ClassCache& cache;
  const Grid& grid;
  GradientScale scale;
  std::vector<ClassLight> classes;
  IndexBox box;  // of the groups
};

GradientScale scale_of(const Grid& grid) {
  constexpr double kReach = 3;  // voxels
  const Affine to_index = lps_mm_to_index(grid);
  GradientScale scale;
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = 0; b < 3; ++b)
      scale.to_lps[a][b] = static_cast<float>(to_index.linear[std::size_t{3} * a + b]);
    scale.per_mm_squared[a] = static_cast<float>(1 / (grid.spacing_mm[a] * grid.spacing_mm[a]));
  }
  scale.reach_mm = static_cast<float>(kReach * std::cbrt(1 / std::abs(determinant(to_index.linear))));
  return scale;
}

/// Groups the drawn classes by the structures that hold them. Returns the box of groups that are lit anew.
IndexBox group_classes(const DrawPlan& plan, const ClassTable& classes, std::vector<ClassLight>& lights) {
  std::map<std::vector<StructureIndex>, std::vector<ClassId>> groups;
  for (const ClassDraw& draw : plan.classes) {
    std::vector<StructureIndex> structures;
    for (const Membership& m : classes.members(draw.id)) {
      if (m.holds()) structures.push_back(m.structure);
    }
    if (draws_volume(draw.role)) groups[structures].push_back(draw.id);
  }
  IndexBox box;
  std::int32_t number = 0;
  for (const auto& [structures, of_group] : groups) {
    if (std::ranges::none_of(of_group, [&](ClassId c) { return lights[c].anew; })) continue;
    ++number;
    for (const ClassId c : of_group) {
      lights[c].group = number;
      box.include(classes.box(c));
    }
  }
  return box;
}

/// Lights slices one after the other.
class SliceLighter {
 public:
  explicit SliceLighter(const LightScene& scene)
      : scene_(scene),
        width_(scene.box.last[0] - scene.box.first[0] + 3),
        rows_(scene.box.last[1] - scene.box.first[1] + 3) {
    const std::size_t floats = static_cast<std::size_t>(width_) + kLightPadding;
    for (std::vector<float>& row : sums_) row.resize(floats);
    for (std::vector<float>& row : floats_) row.resize(floats);
    normals_.resize(floats);
    lit_.resize(floats);
    for (Plane& plane : planes_) {
      plane.values.resize(static_cast<std::size_t>(width_ * rows_) + 2 * kLightPadding);
      plane.groups.resize(plane.values.size());
    }
  }

  void light(std::int64_t slice) {
    for (const std::int64_t near : {slice - 1, slice, slice + 1}) require(near);
    const std::span<const ClassRun> runs = scene_.cache.runs(Axis::kZ).slice(slice);
    for (std::size_t n = 0; n < runs.size();) {
      const std::size_t end = segment_end(runs, n);
      if (of(runs[n]).group != 0) light(slice, runs.subspan(n, end - n));
      n = end;
    }
  }

 private:
  /// The voxels of a slice of the box, padded by one voxel.
  struct Plane {
    std::int64_t slice = std::numeric_limits<std::int64_t>::min();
    std::vector<float> values;
    std::vector<std::int32_t> groups;  // 0 for voxels that do not count
  };

  [[nodiscard]] const ClassLight& of(const ClassRun& run) const { return scene_.classes[run.id]; }
  [[nodiscard]] Plane& plane(std::int64_t slice) { return planes_[static_cast<std::size_t>(slice + 3) % 3]; }
  [[nodiscard]] std::int64_t place(const ClassRun& run) const {
    return (run.row - scene_.box.first[1] + 1) * width_ + (run.start - scene_.box.first[0] + 1);
  }

  void require(std::int64_t slice) {
    Plane& plane = this->plane(slice);
    if (plane.slice == slice) return;
    for (const ClassRun& run : scene_.cache.runs(Axis::kZ).slice(plane.slice)) {
      if (of(run).group != 0) std::fill_n(plane.groups.data() + place(run), run.length, 0);
    }
    plane.slice = slice;
    visit_voxel_type(scene_.cache.value_type(), [&](auto tag) {
      using T = decltype(tag);
      for (const ClassRun& run : scene_.cache.runs(Axis::kZ).slice(slice)) {
        const std::int32_t group = of(run).group;
        if (group == 0) continue;
        const std::int64_t first = scene_.grid.offset(run.start, run.row, slice);
        const auto* from = reinterpret_cast<const T*>(scene_.cache.values()) + first;
        float* const values = plane.values.data() + place(run);
        std::int32_t* const groups = plane.groups.data() + place(run);
        for (std::size_t n = 0; n < run.length; ++n) {
          const auto grey = static_cast<float>(from[n]);
          const bool finite = std::isfinite(grey);
          values[n] = finite ? grey : 0;
          groups[n] = finite ? group : 0;
        }
      }
    });
  }

  /// End of the runs from the n-th on that are of one group and row, with small gaps.
  [[nodiscard]] std::size_t segment_end(std::span<const ClassRun> runs, std::size_t n) const {
    constexpr std::uint32_t kSmallGap = 16;
    std::size_t end = n + 1;
    while (end < runs.size() && of(runs[end]).group == of(runs[n]).group && runs[end].row == runs[n].row &&
           runs[end].start <= runs[end - 1].start + runs[end - 1].length + kSmallGap)
      ++end;
    return end;
  }

  /// Lights a segment.
  void light(std::int64_t slice, std::span<const ClassRun> runs) {
    const ClassRun& first = runs.front();
    const std::size_t count = runs.back().start + runs.back().length - first.start;
    const GradientRow gradients = measure(slice, first, count);
    VoxelLight* const lights = scene_.cache.lights() + scene_.grid.offset(first.start, first.row, slice);
    bool inside = false;
    for (const ClassRun& run : runs) {
      const std::size_t begin = run.start - first.start;
      const bool boundary = of(run).boundary;
      for (std::size_t n = begin; n < begin + run.length; ++n) {
        normals_[n] = lights[n].normal;
        lit_[n] = boundary ? VoxelLight::kAllLit : 0;
      }
      inside = inside || (of(run).anew && !boundary);
    }
    float* const below = floats_[5].data();
    float* const above = floats_[6].data();
    if (inside) {
      const float* greys = plane(slice).values.data() + place(first);
      find_extinctions(*of(first).transfer, greys, gradients.reach, count, below, above);
    }
    kernels_.light(below, above, count, gradients, {normals_.data(), lit_.data()});
    for (const ClassRun& run : runs) {
      if (!of(run).anew) continue;
      const std::size_t begin = run.start - first.start;
      for (std::size_t n = begin; n < begin + run.length; ++n) lights[n] = {normals_[n], lit_[n]};
    }
  }

  GradientRow measure(std::int64_t slice, const ClassRun& first, std::size_t count) {
    GreyRows rows{{}, {}, of(first).group};
    for (std::size_t k = 0; k < 9; ++k) {
      const Plane& plane = this->plane(slice + static_cast<std::int64_t>(k / 3) - 1);
      const std::int64_t at = place(first) + (static_cast<std::int64_t>(k % 3) - 1) * width_;
      rows.values[k] = plane.values.data() + at;
      rows.groups[k] = plane.groups.data() + at;
    }
    std::array<PairSums, 3> sums{};
    for (std::size_t a = 0; a < 3; ++a)
      sums[a] = {sums_[3 * a].data(), sums_[3 * a + 1].data(), sums_[3 * a + 2].data()};
    const GradientRow gradients{
        {floats_[0].data(), floats_[1].data(), floats_[2].data()}, floats_[3].data(), floats_[4].data()};
    kernels_.gradient(rows, count, scene_.scale, sums, gradients);
    return gradients;
  }

  void find_extinctions(const TransferTable& transfer, const float* greys, const float* reach,
                        std::size_t count, float* below, float* above) const {
    if (const TransferTable::View table = transfer.view(); !table.shares.empty())
      return kernels_.extinctions(table, greys, reach, count, below, above);
    for (std::size_t n = 0; n < count; ++n) {
      const auto at = [&](float grey) { return transfer.share_of(static_cast<double>(grey)).extinction; };
      below[n] = at(greys[n] - reach[n]);
      above[n] = at(greys[n] + reach[n]);
    }
  }

  const LightScene& scene_;
  LightKernels kernels_ = light_kernels();
  std::int64_t width_, rows_;
  std::array<Plane, 3> planes_;  // before, at and after a slice
  // Of a segment
  std::array<std::vector<float>, 9> sums_;    // three of each axis
  std::array<std::vector<float>, 7> floats_;  // direction, coherence, reach, extinctions below and above
  std::vector<PackedNormal> normals_;
  std::vector<std::uint16_t> lit_;
};

}  // namespace

void light_voxels(const DrawPlan& plan, const VolumeAppearances& appearances, const ClassTable& classes,
                  const Grid& grid, ClassCache& cache, ThreadPool& pool) {
  if (cache.values() == nullptr) return;
  // Find the classes to light anew
  LightScene scene{cache, grid, scale_of(grid), std::vector<ClassLight>(classes.size()), {}};
  std::vector<std::pair<ClassId, LightState>> anew;
  for (std::size_t n = 0; n < plan.classes.size(); ++n) {
    const ClassDraw& draw = plan.classes[n];
    if (!draws_volume(draw.role)) continue;
    const TransferTable* const transfer = appearances.appearances()[n].transfer;
    const LightState drawn = draw.boundary
                                 ? LightState{LightState::Of::kBorder}
                                 : LightState{LightState::Of::kInterior, transfer, appearances.generation()};
    const bool is_new = cache.light_state(draw.id) != drawn;
    if (is_new) anew.emplace_back(draw.id, drawn);
    scene.classes[draw.id] = {0, draw.boundary, is_new, transfer};
  }
  if (anew.empty()) return;
  scene.box = group_classes(plan, classes, scene.classes);
  for (const auto& [c, drawn] : anew)
    cache.light_state(c) = {LightState::Of::kNothing};  // in case the task is cancelled

  // Light slices in parallel
  const std::int64_t slices = scene.box.last[2] - scene.box.first[2] + 1;
  const std::int64_t at_once = std::max<std::int64_t>(8, slices / (std::int64_t{4} * pool.threads()) + 1);
  pool.for_each(static_cast<std::size_t>((slices + at_once - 1) / at_once), [&](std::size_t part) {
    SliceLighter lighter(scene);
    const std::int64_t first = scene.box.first[2] + static_cast<std::int64_t>(part) * at_once;
    for (std::int64_t slice = first; slice < std::min(first + at_once, scene.box.last[2] + 1); ++slice) {
      check_task();
      lighter.light(slice);
    }
  });
  for (const auto& [c, drawn] : anew) cache.light_state(c) = drawn;
}

}  // namespace splatlas
