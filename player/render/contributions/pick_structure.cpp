#include "player/render/contributions/pick_structure.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <utility>

#include "format/content/run_model.h"

namespace splatlas {
namespace {

/// Minimum contribution to a pixel of a structure that can be picked.
constexpr double kMinContribution = 0.02;

struct Contribution {
  double total = 0, max_share = 0, plane = 0;
};

/// Contributions of structures to a pixel, accumulated front to back.
class RayWalk {
 public:
  void add(StructureIndex structure, double opacity, double plane) {
    Contribution& c = contributions_[structure];
    const double share = transmittance_ * opacity;
    c.total += share;
    if (share > c.max_share) {
      c.max_share = share;
      c.plane = plane;
    }
    transmittance_ *= 1 - opacity;
  }
  /// The structure and its point. `shown` wins if it contributes.
  [[nodiscard]] std::optional<std::pair<StructureIndex, double>> winner(StructureIndex shown) const {
    if (const auto found = contributions_.find(shown);
        found != contributions_.end() && found->second.total > 0)
      return std::pair(found->first, found->second.plane);
    const auto best =
        std::max_element(contributions_.begin(), contributions_.end(), [](const auto& a, const auto& b) {
          return a.second.total != b.second.total ? a.second.total < b.second.total : a.first > b.first;
        });
    if (best == contributions_.end() || best->second.total < kMinContribution) return std::nullopt;
    return std::pair(best->first, best->second.plane);
  }

 private:
  double transmittance_ = 1;
  std::unordered_map<StructureIndex, Contribution> contributions_;
};

/// Fragments of the pixel's sample nearest to picture coordinates (x, y).
std::span<const Fragment> nearest_sample(const FragmentList& list, int row, std::uint32_t pixel, double x,
                                         double y) {
  std::span<const Fragment> nearest;
  double min_distance = HUGE_VAL;
  const std::uint32_t end = list.first_of_row[static_cast<std::size_t>(row) + 1];
  for (std::uint32_t n = list.first_of_row[static_cast<std::size_t>(row)]; n < end; ++n) {
    const Sample& sample = list.samples[n];
    if (sample.pixel != pixel) continue;
    const double distance =
        std::hypot(std::floor(x) + sample.place.right() - x, std::floor(y) + sample.place.down() - y);
    if (distance >= min_distance) continue;
    min_distance = distance;
    nearest = list.of_sample(n);
  }
  return nearest;
}

/// Ray in continuous voxel indices: it crosses plane k of the grid at origin + k * per_plane.
struct PickRay {
  std::size_t axis = 2;  // normal of the planes
  Vec3 origin{}, per_plane{};
  double slab_mm = 0;  // length of the ray between two planes
  double from = 0;     // position of the eye along the axis; infinite in parallel views
  bool ascending = true;
  ClipDepths kept;             // of a cut: position along the axis, in the direction of the ray
  RayFaces faces;              // of a cut
  double front = 0, back = 0;  // positions of the faces along the axis

  PickRay(const Grid& grid, const ShownFrame& frame, double x, double y) {
    const View& view = frame.view;
    const ViewDepth depth(view, grid);
    const Vec3 start = depth.index_at(x, y, 0);
    const Vec3 further = depth.index_at(x, y, reach_mm(view));
    Vec3 along{};
    for (std::size_t a = 0; a < 3; ++a) along[a] = further[a] - start[a];
    for (const std::size_t a : {1u, 0u}) {
      if (std::abs(along[a]) > std::abs(along[axis])) axis = a;
    }
    if (frame.sheets) axis = static_cast<std::size_t>(*frame.sheets);
    ascending = along[axis] > 0;
    for (std::size_t a = 0; a < 3; ++a) {
      per_plane[a] = along[a] / along[axis];
      origin[a] = start[a] - start[axis] * per_plane[a];
    }
    origin[axis] = 0;
    const Vec3 slab = index_to_lps_mm(grid).apply_linear(per_plane);
    slab_mm = std::sqrt(dot(slab, slab));
    if (!frame.cuts.empty()) cut(grid, frame, x, y);
    from = view.eye_mm ? depth.index_at(x, y, -*view.eye_mm)[axis] : ascending ? -HUGE_VAL : HUGE_VAL;
  }

  [[nodiscard]] Vec3 at(double plane) const {
    Vec3 index{};
    for (std::size_t a = 0; a < 3; ++a) index[a] = origin[a] + plane * per_plane[a];
    return index;
  }
  /// Kept part of the slab around a plane of voxels, 0 to 1.
  [[nodiscard]] double kept_part(double plane) const {
    const double along = ascending ? plane : -plane;
    return std::clamp(std::min(along + 0.5, kept.to) - std::max(along - 0.5, kept.from), 0.0, 1.0);
  }
  [[nodiscard]] bool is_behind_eye(double plane) const { return ascending ? plane < from : plane > from; }

 private:
  /// Clips the ray by the frame's cut, and finds its faces.
  void cut(const Grid& grid, const ShownFrame& frame, double x, double y) {
    const CutRays cuts(frame.cuts, frame.view, grid);
    kept = cuts.depths(x, y, axis, ascending ? 1 : -1);
    if (frame.faces == nullptr) return;
    faces = ViewFaces(*frame.faces, cuts, frame.caps, axis, 1).through(x, y);
    front = static_cast<double>(faces.front.depth);
    back = static_cast<double>(faces.back.depth);
  }

  /// Length of the segment that defines the ray's direction, at the scale of the view.
  static double reach_mm(const View& view) {
    return view.eye_mm.value_or(view.plane.mm_per_pixel * (view.plane.size.width + view.plane.size.height));
  }
};

}  // namespace

std::optional<Pick> pick_structure(const PickScene& scene, double x, double y) {
  const PictureSize& size = scene.frame.view.plane.size;
  if (!(x >= 0 && y >= 0 && x < size.width && y < size.height)) return std::nullopt;
  const PickRay ray(scene.grid, scene.frame, x, y);
  const auto row = static_cast<int>(y);
  const auto pixel = static_cast<std::uint32_t>(row * size.width + static_cast<int>(x));

  const std::span<const Fragment> surfaces = nearest_sample(scene.fragments, row, pixel, x, y);
  std::size_t next_surface = 0;
  const double sign = ray.ascending ? 1 : -1;
  const auto plane_of = [&](const Fragment& fragment) {
    const std::size_t a = scene.frame.depth_axis;
    return (scene.frame.depth_sign * static_cast<double>(fragment.depth) - ray.origin[a]) / ray.per_plane[a];
  };
  RayWalk walk;
  const auto pass_surfaces = [&](double plane) {
    for (; next_surface < surfaces.size(); ++next_surface) {
      const Fragment& fragment = surfaces[next_surface];
      if (sign * plane_of(fragment) > sign * plane) break;
      walk.add(fragment.structure, fragment.rgba[3], plane_of(fragment));
    }
  };

  if (ray.faces.front.shows()) walk.add(ray.faces.front.structure, ray.faces.front.rgba[3], ray.front);
  const ScanOrder order = ScanOrder::of(scene.runs.axis());
  const std::size_t along = ray.axis == order.scan_axis ? 0 : ray.axis == order.row_axis ? 1 : 2;
  const std::int64_t first = scene.runs.box().first[along], last = scene.runs.box().last[along];
  for (std::int64_t n = 0; n <= last - first; ++n) {
    const std::int64_t k = ray.ascending ? first + n : last - n;
    const auto plane = static_cast<double>(k);
    const double kept_part = ray.kept_part(plane);
    if (ray.is_behind_eye(plane) || kept_part <= 0) continue;
    pass_surfaces(plane);
    const Vec3 at = ray.at(plane);
    Index3 voxel{std::llround(at[0]), std::llround(at[1]), std::llround(at[2])};
    voxel[ray.axis] = k;
    if (!scene.grid.contains(voxel[0], voxel[1], voxel[2])) continue;
    const ClassRun* run =
        scene.runs.at(voxel[order.slice_axis], voxel[order.row_axis], voxel[order.scan_axis]);
    if (run == nullptr) continue;
    ClassifiedVoxel appearance;
    const std::uint32_t draw = scene.runs.draw_of(run->id);
    scene.appearances[draw].look_up(scene.cache.values(),
                                    static_cast<std::size_t>(scene.grid.offset(voxel[0], voxel[1], voxel[2])),
                                    1, 1, &appearance);
    const double depth = static_cast<double>(appearance.extinction_per_mm) * ray.slab_mm * kept_part;
    walk.add(scene.plan.classes[draw].volume_of, -std::expm1(-depth), plane);
  }
  pass_surfaces(sign * HUGE_VAL);
  if (ray.faces.back.shows()) walk.add(ray.faces.back.structure, ray.faces.back.rgba[3], ray.back);

  const StructureIndex shown =
      scene.ids.empty() ? kNoStructure : scene.ids.at(static_cast<int>(x), static_cast<int>(y));
  const auto winner = walk.winner(shown);
  if (!winner) return std::nullopt;
  return Pick{winner->first, index_to_lps_mm(scene.grid).apply(ray.at(winner->second))};
}

}  // namespace splatlas
