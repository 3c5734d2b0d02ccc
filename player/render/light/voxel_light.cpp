#include "player/render/light/voxel_light.h"

#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "format/tasks/task_control.h"

namespace splatlas {
namespace {

/// How a class is lit anew.
struct ClassLight {
  std::int32_t structure = 0;               // whose voxels count for the gradient, from 1 on; 0: not lit anew
  const TransferTable* transfer = nullptr;  // null for borders
};

/// Structures without common classes.
struct LightPass {
  std::vector<std::int32_t> structures;  // [class], from 1 on; 0: none
  IndexBox box;
};

/// Input that all slices share.
struct LightScene {
  ClassCache& cache;
  const Grid& grid;
  GradientScale scale;
  std::vector<ClassLight> classes;
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

/// Divides the structures of classes that are lit anew into passes. Overlaps alone need more than one.
std::vector<LightPass> passes_of(const DrawPlan& plan, const ClassTable& classes,
                                 const std::vector<ClassLight>& lights) {
  std::map<StructureIndex, std::vector<ClassId>> structures;  // and the drawn classes that they hold
  for (const ClassDraw& draw : plan.classes) {
    if (lights[draw.id].structure != 0) structures[draw.volume_of];
  }
  for (const ClassDraw& draw : plan.classes) {
    if (!draws_volume(draw.role)) continue;
    for (const Membership& m : classes.members(draw.id)) {
      const auto known = m.holds() ? structures.find(m.structure) : structures.end();
      if (known != structures.end()) known->second.push_back(draw.id);
    }
  }
  std::vector<LightPass> passes;
  for (const auto& structure_and_held : structures) {
    const std::vector<ClassId>& held = structure_and_held.second;
    const auto has_room = [&held](const LightPass& pass) {
      return std::ranges::all_of(held, [&](ClassId c) { return pass.structures[c] == 0; });
    };
    auto pass = std::ranges::find_if(passes, has_room);
    if (pass == passes.end()) {
      check_memory(static_cast<double>(passes.size()) * static_cast<double>(classes.size()) * 4);
      pass = passes.insert(pass, {std::vector<std::int32_t>(classes.size()), {}});
    }
    for (const ClassId c : held) {
      pass->structures[c] = static_cast<std::int32_t>(structure_and_held.first) + 1;
      pass->box.include(classes.box(c));
    }
  }
  return passes;
}

/// Lights slices one after the other.
class SliceLighter {
 public:
  SliceLighter(const LightScene& scene, const LightPass& pass)
      : scene_(scene),
        pass_(pass),
        width_(pass.box.last[0] - pass.box.first[0] + 3),
        rows_(pass.box.last[1] - pass.box.first[1] + 3) {
    const std::size_t floats = static_cast<std::size_t>(width_) + kLightPadding;
    for (std::vector<float>& row : sums_) row.resize(floats);
    for (std::vector<float>& row : floats_) row.resize(floats);
    normals_.resize(floats);
    lit_.resize(floats);
    for (Plane& plane : planes_) {
      plane.values.resize(static_cast<std::size_t>(width_ * rows_) + 2 * kLightPadding);
      plane.structures.resize(plane.values.size());
    }
  }

  void light(std::int64_t slice) {
    for (const std::int64_t near : {slice - 1, slice, slice + 1}) require(near);
    const std::span<const ClassRun> runs = scene_.cache.runs(Axis::kZ).slice(slice);
    for (std::size_t n = 0; n < runs.size();) {
      const std::size_t end = segment_end(runs, n);
      const std::span<const ClassRun> segment = runs.subspan(n, end - n);
      if (std::ranges::any_of(segment, [&](const ClassRun& run) { return is_new(run); }))
        light(slice, segment);
      n = end;
    }
  }

 private:
  /// The voxels of a slice of the box, padded by one voxel.
  struct Plane {
    std::int64_t slice = std::numeric_limits<std::int64_t>::min();
    std::vector<float> values;
    std::vector<std::int32_t> structures;  // from 1 on; 0 for voxels that do not count
  };

  [[nodiscard]] const ClassLight& of(const ClassRun& run) const { return scene_.classes[run.id]; }
  [[nodiscard]] std::int32_t structure(const ClassRun& run) const { return pass_.structures[run.id]; }
  /// True for voxels to light in this pass.
  [[nodiscard]] bool is_new(const ClassRun& run) const {
    return structure(run) != 0 && of(run).structure == structure(run);
  }
  [[nodiscard]] Plane& plane(std::int64_t slice) { return planes_[static_cast<std::size_t>(slice + 3) % 3]; }
  [[nodiscard]] std::int64_t place(const ClassRun& run) const {
    return (run.row - pass_.box.first[1] + 1) * width_ + (run.start - pass_.box.first[0] + 1);
  }

  void require(std::int64_t slice) {
    Plane& plane = this->plane(slice);
    if (plane.slice == slice) return;
    for (const ClassRun& run : scene_.cache.runs(Axis::kZ).slice(plane.slice)) {
      if (structure(run) != 0) std::fill_n(plane.structures.data() + place(run), run.length, 0);
    }
    plane.slice = slice;
    visit_voxel_type(scene_.cache.value_type(), [&](auto tag) {
      using T = decltype(tag);
      for (const ClassRun& run : scene_.cache.runs(Axis::kZ).slice(slice)) {
        const std::int32_t structure = this->structure(run);
        if (structure == 0) continue;
        const std::int64_t first = scene_.grid.offset(run.start, run.row, slice);
        const auto* from = reinterpret_cast<const T*>(scene_.cache.values()) + first;
        float* const values = plane.values.data() + place(run);
        std::int32_t* const structures = plane.structures.data() + place(run);
        for (std::size_t n = 0; n < run.length; ++n) {
          const auto grey = static_cast<float>(from[n]);
          const bool finite = std::isfinite(grey);
          values[n] = finite ? grey : 0;
          structures[n] = finite ? structure : 0;
        }
      }
    });
  }

  /// End of the runs from the n-th on that are of one structure and row, with small gaps.
  [[nodiscard]] std::size_t segment_end(std::span<const ClassRun> runs, std::size_t n) const {
    constexpr std::uint32_t kSmallGap = 16;
    std::size_t end = n + 1;
    while (end < runs.size() && structure(runs[end]) == structure(runs[n]) && runs[end].row == runs[n].row &&
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
    const TransferTable* transfer = nullptr;  // the interiors of a structure share one
    for (const ClassRun& run : runs) {
      const std::size_t begin = run.start - first.start;
      const TransferTable* const of_run = of(run).transfer;
      for (std::size_t n = begin; n < begin + run.length; ++n) {
        normals_[n] = lights[n].normal;
        lit_[n] = of_run == nullptr ? VoxelLight::kAllLit : 0;
      }
      if (is_new(run) && of_run != nullptr) transfer = of_run;
    }
    float* const below = floats_[5].data();
    float* const above = floats_[6].data();
    if (transfer != nullptr) {
      const float* greys = plane(slice).values.data() + place(first);
      find_extinctions(*transfer, greys, gradients.reach, count, below, above);
    }
    kernels_.light(below, above, count, gradients, {normals_.data(), lit_.data()});
    for (const ClassRun& run : runs) {
      if (!is_new(run)) continue;
      const std::size_t begin = run.start - first.start;
      for (std::size_t n = begin; n < begin + run.length; ++n) lights[n] = {normals_[n], lit_[n]};
    }
  }

  GradientRow measure(std::int64_t slice, const ClassRun& first, std::size_t count) {
    GreyRows rows{{}, {}, structure(first)};
    for (std::size_t k = 0; k < 9; ++k) {
      const Plane& plane = this->plane(slice + static_cast<std::int64_t>(k / 3) - 1);
      const std::int64_t at = place(first) + (static_cast<std::int64_t>(k % 3) - 1) * width_;
      rows.values[k] = plane.values.data() + at;
      rows.structures[k] = plane.structures.data() + at;
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
  const LightPass& pass_;
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
  // Find the classes to light anew, and how the plan draws them
  std::vector<std::pair<ClassId, LightState>> anew;
  for (std::size_t n = 0; n < plan.classes.size(); ++n) {
    const ClassDraw& draw = plan.classes[n];
    if (!draws_volume(draw.role)) continue;
    LightState drawn{LightState::Of::kBorder, draw.volume_of};
    if (!draw.boundary) {
      drawn = {LightState::Of::kInterior, draw.volume_of, appearances.appearances()[n].transfer,
               appearances.generation()};
    }
    if (cache.light_state(draw.id) != drawn) anew.emplace_back(draw.id, drawn);
  }
  if (anew.empty()) return;
  LightScene scene{cache, grid, scale_of(grid), std::vector<ClassLight>(classes.size())};
  for (const auto& [c, drawn] : anew) {
    scene.classes[c] = {static_cast<std::int32_t>(drawn.structure) + 1, drawn.transfer};
    cache.light_state(c) = {LightState::Of::kNothing};  // in case the task is cancelled
  }

  // Light slices in parallel
  for (const LightPass& pass : passes_of(plan, classes, scene.classes)) {
    const std::int64_t slices = pass.box.last[2] - pass.box.first[2] + 1;
    const std::int64_t at_once = std::max<std::int64_t>(8, slices / (std::int64_t{4} * pool.threads()) + 1);
    pool.for_each(static_cast<std::size_t>((slices + at_once - 1) / at_once), [&](std::size_t part) {
      SliceLighter lighter(scene, pass);
      const std::int64_t first = pass.box.first[2] + static_cast<std::int64_t>(part) * at_once;
      for (std::int64_t slice = first; slice < std::min(first + at_once, pass.box.last[2] + 1); ++slice) {
        check_task();
        lighter.light(slice);
      }
    });
  }
  for (const auto& [c, drawn] : anew) cache.light_state(c) = drawn;
}

}  // namespace splatlas
