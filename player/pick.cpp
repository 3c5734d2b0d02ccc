#include "player/pick.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <vector>

namespace splatlas {
namespace {

/// A structure too faint to be meant: less than this share of the pixel.
constexpr double kFaintest = 0.02;

struct Contribution {
  double total = 0, strongest = 0, slice = 0;
};

/// Front to back: who contributes how much.
class RayWalk {
 public:
  void add(StructureIndex structure, double opacity, double slice) {
    Contribution& c = contributions_[structure];
    const double share = through_ * opacity;
    c.total += share;
    if (share > c.strongest) {
      c.strongest = share;
      c.slice = slice;
    }
    through_ *= 1 - opacity;
  }
  [[nodiscard]] std::optional<std::pair<StructureIndex, double>> winner() const {
    const auto best =
        std::max_element(contributions_.begin(), contributions_.end(), [](const auto& a, const auto& b) {
          return a.second.total != b.second.total ? a.second.total < b.second.total : a.first > b.first;
        });
    if (best == contributions_.end() || best->second.total < kFaintest) return std::nullopt;
    return std::pair(best->first, best->second.slice);
  }

 private:
  double through_ = 1;
  std::unordered_map<StructureIndex, Contribution> contributions_;
};

/// Fragments of the sample of a pixel that is nearest to picture coordinates (x, y).
std::span<const Fragment> nearest_sample(const FragmentList& list, int row, std::uint32_t pixel, double x,
                                         double y) {
  std::span<const Fragment> nearest;
  double least = HUGE_VAL;
  const std::uint32_t end = list.first_of_row[static_cast<std::size_t>(row) + 1];
  for (std::uint32_t n = list.first_of_row[static_cast<std::size_t>(row)]; n < end; ++n) {
    const Sample& sample = list.samples[n];
    if (sample.pixel != pixel) continue;
    const double distance =
        std::hypot(std::floor(x) + sample.place.right() - x, std::floor(y) + sample.place.down() - y);
    if (distance >= least) continue;
    least = distance;
    nearest = list.of_sample(n);
  }
  return nearest;
}

}  // namespace

std::optional<Pick> pick_structure(const PickScene& scene, const ParallelView& view, const Shear& shear,
                                   double x, double y) {
  if (!(x >= 0 && y >= 0 && x < view.size.width && y < view.size.height)) return std::nullopt;
  const Affine2& map = shear.picture_to_sheet;
  const double u = map.xx * x + map.xy * y + map.x0;
  const double v = map.yx * x + map.yy * y + map.y0;
  const auto row = static_cast<int>(y);
  const auto pixel = static_cast<std::uint32_t>(row * view.size.width + static_cast<int>(x));

  const std::span<const Fragment> surfaces = nearest_sample(scene.fragments, row, pixel, x, y);
  std::size_t next_surface = 0;
  const double depth_sign = shear.ascending ? 1 : -1;
  RayWalk walk;
  const auto pass_surfaces = [&](double depth) {
    for (; next_surface < surfaces.size() && surfaces[next_surface].depth <= depth; ++next_surface) {
      const Fragment& fragment = surfaces[next_surface];
      walk.add(fragment.structure, fragment.rgba[3], depth_sign * fragment.depth);
    }
  };

  const IndexBox& box = scene.runs.box();
  for (std::int64_t n = 0; n < scene.runs.slices(); ++n) {
    const std::int64_t k = shear.ascending ? box.first[2] + n : box.last[2] - n;
    const auto slice = static_cast<double>(k);
    pass_surfaces(depth_sign * slice);
    const std::int64_t scan = std::llround(u - shear.u_shift(slice));
    const std::int64_t scan_row = std::llround(v - shear.v_shift(slice));
    const ClassRun* run = scene.runs.at(k, scan_row, scan);
    if (run == nullptr) continue;
    Index3 voxel{};
    voxel[shear.scan.slice_axis] = k;
    voxel[shear.scan.row_axis] = scan_row;
    voxel[shear.scan.scan_axis] = scan;
    VoxelLook look;
    const std::uint32_t draw = scene.runs.draw_of(run->id);
    scene.looks[draw].look_up(scene.cache.values(),
                              static_cast<std::size_t>(scene.grid.offset(voxel[0], voxel[1], voxel[2])), 1, 1,
                              &look);
    const double depth = static_cast<double>(look.extinction_per_mm) * shear.slab_mm;
    walk.add(scene.plan.classes[draw].volume_of, -std::expm1(-depth), slice);
  }
  pass_surfaces(HUGE_VAL);

  const auto winner = walk.winner();
  if (!winner) return std::nullopt;
  const double slice = winner->second;
  Vec3 index{};
  index[shear.scan.slice_axis] = slice;
  index[shear.scan.row_axis] = v - shear.v_shift(slice);
  index[shear.scan.scan_axis] = u - shear.u_shift(slice);
  return Pick{winner->first, index_to_lps_mm(scene.grid).apply(index)};
}

}  // namespace splatlas
