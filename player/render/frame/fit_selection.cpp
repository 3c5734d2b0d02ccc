#include "player/render/frame/fit_selection.h"

#include <cmath>
#include <vector>

#include "format/result_macros.h"
#include "player/render/clip/cut_rays.h"
#include "player/render/decode/selected_runs.h"

namespace splatlas {
namespace {

/// Order of FitPlanes.
enum : std::size_t { kUp, kDown, kRight, kLeft, kFar, kNear };

/// Distance of the eye from the nearest point, relative to the depth of all points.
constexpr double kMinEyeDistance = 1e-3;

/// Distance of interpolation from the centre of a voxel, along each axis.
constexpr double kVolumeReach = 1;
constexpr std::size_t kVerticesPerJob = 16384;

/// Voxels [first, last] of a scanline.
struct ReachedVoxels {
  double first, last;
};

/// Voxels of a scanline that the kept part of a cut reaches, by interpolation.
ReachedVoxels reached_voxels(std::span<const VoxelPlane> planes, const ScanOrder& order, std::int64_t slice,
                             std::int64_t row) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Vec3 start{};
  start[order.slice_axis] = static_cast<double>(slice);
  start[order.row_axis] = static_cast<double>(row);
  double from = -kInfinity, to = kInfinity;
  for (const VoxelPlane& plane : planes) {
    const Vec3& n = plane.normal;
    const double reach = kVolumeReach * (std::abs(n[0]) + std::abs(n[1]) + std::abs(n[2]));
    const double at = plane.distance(start) - reach, per_voxel = n[order.scan_axis];
    if (per_voxel > 0) to = std::min(to, -at / per_voxel);
    if (per_voxel < 0) from = std::max(from, -at / per_voxel);
    if (per_voxel == 0 && at > 0) to = -kInfinity;
  }
  return {std::ceil(from), std::floor(to)};
}

/// Extents of the centres of a slice's kept voxels. Only the ends of a scanline matter.
FitExtents extents_of_slice(const SelectedRuns& runs, std::int64_t slice,
                            std::span<const VoxelPlane> cut_planes, const FitPlanes& planes) {
  const ScanOrder order = ScanOrder::of(runs.axis());
  FitExtents extents;
  std::int64_t row = -1;
  ReachedVoxels kept{}, line{0, -1};  // of the row; `line` is empty if it has no voxel
  const auto finish_line = [&] {
    if (line.first > line.last) return;
    for (const double voxel : {line.first, line.last}) {
      Vec3 end{};
      end[order.slice_axis] = static_cast<double>(slice);
      end[order.row_axis] = static_cast<double>(row);
      end[order.scan_axis] = voxel;
      extents.include(planes, end);
    }
  };
  runs.for_each(slice, [&](const ClassRun& run, std::uint32_t) {
    if (run.row != row) {
      finish_line();
      row = run.row;
      kept = reached_voxels(cut_planes, order, slice, row);
      line = {0, -1};
    }
    const double first = std::max<double>(run.start, kept.first);
    const double last = std::min(static_cast<double>(run.start) + run.length - 1, kept.last);
    if (first > last) return;
    if (line.first > line.last) line.first = first;
    line.last = last;
  });
  finish_line();
  return extents;
}

FitExtents extents_of_volume(const SelectedRuns& runs, std::span<const VoxelPlane> cut_planes,
                             const FitPlanes& planes, ThreadPool& pool) {
  const std::span<const std::int64_t> slices = runs.occupied();
  std::vector<FitExtents> of_slices(slices.size());
  pool.for_each(slices.size(),
                [&](std::size_t n) { of_slices[n] = extents_of_slice(runs, slices[n], cut_planes, planes); });
  FitExtents extents;
  for (const FitExtents& of_slice : of_slices) extents.include(of_slice);
  if (!extents.empty()) extents.grow(planes, kVolumeReach);
  return extents;
}

/// Clips a convex polygon (Sutherland and Hodgman 1974).
void clip_polygon(std::vector<Vec3>& polygon, const VoxelPlane& plane, std::vector<Vec3>& scratch) {
  scratch.clear();
  for (std::size_t n = 0; n < polygon.size(); ++n) {
    const Vec3 &a = polygon[n], &b = polygon[n + 1 < polygon.size() ? n + 1 : 0];
    const double at_a = plane.distance(a), at_b = plane.distance(b);
    if (at_a <= 0) scratch.push_back(a);
    if ((at_a <= 0) == (at_b <= 0)) continue;
    const double t = at_a / (at_a - at_b);
    Vec3 crossing{};
    for (std::size_t k = 0; k < 3; ++k) crossing[k] = a[k] + t * (b[k] - a[k]);
    scratch.push_back(crossing);
  }
  polygon.swap(scratch);
}

/// Calls extents_of(first, last) for ranges of `count` items in parallel, and merges its results.
template <typename ExtentsOf>
FitExtents merged_extents(std::size_t count, ThreadPool& pool, const ExtentsOf& extents_of) {
  std::vector<FitExtents> of_jobs((count + kVerticesPerJob - 1) / kVerticesPerJob);
  pool.for_each(of_jobs.size(), [&](std::size_t job) {
    of_jobs[job] = extents_of(job * kVerticesPerJob, std::min(count, (job + 1) * kVerticesPerJob));
  });
  FitExtents extents;
  for (const FitExtents& of_job : of_jobs) extents.include(of_job);
  return extents;
}

FitExtents extents_of_surface(const SurfaceMesh& mesh, std::span<const VoxelPlane> cut_planes,
                              const FitPlanes& planes, ThreadPool& pool) {
  const auto position = [&](std::size_t vertex) {
    const auto& p = mesh.positions_ijk[vertex];
    return Vec3{p[0], p[1], p[2]};
  };
  if (cut_planes.empty()) {
    return merged_extents(mesh.positions_ijk.size(), pool, [&](std::size_t first, std::size_t last) {
      FitExtents extents;
      for (std::size_t n = first; n < last; ++n) extents.include(planes, position(n));
      return extents;
    });
  }
  return merged_extents(mesh.triangles.size(), pool, [&](std::size_t first, std::size_t last) {
    FitExtents extents;
    std::vector<Vec3> polygon, scratch;
    for (std::size_t n = first; n < last; ++n) {
      const auto& corners = mesh.triangles[n];
      polygon = {position(corners[0]), position(corners[1]), position(corners[2])};
      for (const VoxelPlane& plane : cut_planes) clip_polygon(polygon, plane, scratch);
      for (const Vec3& corner : polygon) extents.include(planes, corner);
    }
    return extents;
  });
}

}  // namespace

void FitExtents::grow(const FitPlanes& planes, double reach) {
  for (std::size_t n = 0; n < FitPlanes::kCount; ++n) {
    const Vec3& gradient = planes.gradient[n];
    max_[n] += reach * (std::abs(gradient[0]) + std::abs(gradient[1]) + std::abs(gradient[2]));
  }
}

Result<FitFrame> FitFrame::of(const Camera& camera, const PictureSize& size, const Display& display,
                              const PictureRegion& region) {
  const bool is_inside = region.left >= 0 && region.left < region.right && region.right <= 1 &&
                         region.top >= 0 && region.top < region.bottom && region.bottom <= 1;
  if (!is_inside) {
    return fail(ErrorCode::kUsage,
                "camera: region of the picture from ({}, {}) to ({}, {}): must lie within (0, 0) to (1, 1)",
                region.left, region.top, region.right, region.bottom);
  }
  Camera whole = camera;
  whole.zoom = 1;
  whole.center_lps_mm.reset();
  SPLATLAS_ASSIGN_OR_RETURN(const View view, view_of(whole, size, display));
  return FitFrame(whole, view, region);
}

FitFrame::FitFrame(const Camera& camera, const View& view, const PictureRegion& region)
    : camera_(camera),
      view_(view),
      half_height_mm_(0.5 * view.plane.size.height * view.plane.mm_per_pixel),
      slope_(view.eye_mm ? half_height_mm_ / *view.eye_mm : 0) {
  const double aspect = static_cast<double>(view.plane.size.width) / view.plane.size.height;
  middle_right_ = aspect * (region.left + region.right - 1);
  middle_up_ = 1 - region.top - region.bottom;
  half_width_ = kFill * aspect * (region.right - region.left);
  half_height_ = kFill * (region.bottom - region.top);
}

FitPlanes FitFrame::planes(const Affine& to_lps_mm) const {
  // A point is inside the margins if |up - middle_up * h| <= half_height * h, and
  // |right - middle_right * h| <= half_width * h, for h = H + depth * slope and the picture's half height H
  FitPlanes planes;
  Vec3 offset = to_lps_mm.offset;  // from the centre of the bounding sphere
  for (std::size_t a = 0; a < 3; ++a) offset[a] -= view_.plane.center_lps_mm[a];
  const auto set = [&](std::size_t n, const Vec3& side, double sign, double depths) {
    Vec3 normal{};
    for (std::size_t a = 0; a < 3; ++a) normal[a] = sign * side[a] + depths * view_.plane.forward_lps[a];
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t b = 0; b < 3; ++b) planes.gradient[n][a] += normal[b] * to_lps_mm.linear[3 * b + a];
      planes.offset[n] += normal[a] * offset[a];
    }
  };
  set(kUp, view_.plane.up_lps, 1, -(half_height_ + middle_up_) * slope_);
  set(kDown, view_.plane.up_lps, -1, -(half_height_ - middle_up_) * slope_);
  set(kRight, view_.plane.right_lps, 1, -(half_width_ + middle_right_) * slope_);
  set(kLeft, view_.plane.right_lps, -1, -(half_width_ - middle_right_) * slope_);
  set(kFar, {}, 0, 1);
  set(kNear, {}, 0, -1);
  return planes;
}

/// The half height of the picture in the plane of depth 0.
double FitFrame::fitted_half_height(const FitExtents& extents) const {
  if (narrowed_) return *narrowed_;
  const double half_height =
      std::max(extents.half(kUp, kDown) / half_height_, extents.half(kRight, kLeft) / half_width_);
  if (slope_ == 0) return half_height;
  const double nearest = -extents.max(kNear) - kMinEyeDistance * extents.half(kFar, kNear);
  return std::max(half_height, -nearest * slope_);
}

bool FitFrame::narrow(const FitExtents& extents) {
  constexpr double kCentred = 1e-8;  // half heights of the picture
  if (slope_ == 0) return false;
  narrowed_ = fitted_half_height(extents);
  // Planes of half angle t that touch the points on both sides have t = (half + t * depth) / (height +
  // depth). With the middle depth, the right side is a contraction.
  const double depth = extents.middle(kFar, kNear) * slope_;
  if (*narrowed_ + depth <= 0) return false;  // a single point
  const auto of_points = [&](double t, double half) { return (half + t * depth) / (*narrowed_ + depth); };
  const double height = of_points(half_height_, extents.half(kUp, kDown));
  const double width = of_points(half_width_, extents.half(kRight, kLeft));
  const double change = std::max(std::abs(height - half_height_), std::abs(width - half_width_));
  half_height_ = height;
  half_width_ = width;
  return change > kCentred;
}

Camera FitFrame::fitted(const FitExtents& extents) const {
  // Find the middle of the picture in the plane of depth 0
  double half_height = fitted_half_height(extents);
  const double right = extents.middle(kRight, kLeft) - middle_right_ * half_height;
  const double up = extents.middle(kUp, kDown) - middle_up_ * half_height;

  // Move the plane to the middle of the points
  const double depth = extents.middle(kFar, kNear);
  half_height += depth * slope_;
  Camera camera = camera_;
  camera.zoom = half_height > 0 ? std::clamp(half_height_mm_ / half_height, kMinZoom, kMaxZoom) : kMaxZoom;
  Vec3 center = view_.plane.center_lps_mm;
  for (std::size_t a = 0; a < 3; ++a) {
    center[a] +=
        right * view_.plane.right_lps[a] + up * view_.plane.up_lps[a] + depth * view_.plane.forward_lps[a];
  }
  camera.center_lps_mm = center;
  return camera;
}

Result<Camera> within_reach(const Camera& fitted) {
  if (!fitted.center_lps_mm || is_within_reach(*fitted.center_lps_mm)) return fitted;
  const auto& [x, y, z] = *fitted.center_lps_mm;
  return fail(
      ErrorCode::kFailed,
      "the middle of the selection, at ({:.17g}, {:.17g}, {:.17g}) mm, is more than {} mm from the origin; "
      "build the atlas from images with an origin nearer to 0",
      x, y, z, kMaxMm);
}

DrawPlan part_of(const DrawPlan& plan, std::span<const StructureIndex> structures, const Atlas& atlas) {
  std::vector<bool> wanted(atlas.graph().size());
  for (const StructureIndex s : structures) {
    if (s < wanted.size()) wanted[s] = true;
  }
  DrawPlan part;
  for (const ClassDraw& draw : plan.classes) {
    const auto members = atlas.classes().members(draw.id);
    const auto is_wanted = [&](const Membership& of) { return of.holds() && wanted[of.structure]; };
    if (std::ranges::any_of(members, is_wanted)) part.classes.push_back(draw);
  }
  for (const StructureIndex s : plan.surfaces) {
    if (wanted[s]) part.surfaces.push_back(s);
  }
  return part;
}

FitExtents extents_of(const DrawPlan& plan, const Atlas& atlas, const ClassCache& cache, Axis axis,
                      int surface_level, const CutPlanes& cuts, const FitPlanes& planes, ThreadPool& pool) {
  const std::vector<VoxelPlane> cut_planes = voxel_planes(cuts, atlas.grid());
  FitExtents extents;
  if (!volume_classes(plan).empty()) {
    const SelectedRuns runs(plan, atlas.classes(), cache, axis);
    extents = extents_of_volume(runs, cut_planes, planes, pool);
  }
  for (const StructureIndex s : plan.surfaces) {
    extents.include(extents_of_surface(cache.surface(s, surface_level).mesh, cut_planes, planes, pool));
  }
  return extents;
}

}  // namespace splatlas
