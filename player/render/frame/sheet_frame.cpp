#include "player/render/frame/sheet_frame.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "format/result_macros.h"
#include "player/render/contributions/pixel_shares.h"
#include "player/render/frame/ray_frame.h"
#include "player/render/frame/stopwatch.h"
#include "player/render/sheets/sheets.h"
#include "player/render/sheets/spans/span_model.h"
#include "player/render/sheets/splat/splat_kernels.h"

namespace splatlas {
namespace {

/// Extent in (u, v) of the part of a box that the planes keep, with a margin for slabs and pixels. `first`,
/// `last`: corners in continuous voxel indices.
struct SheetExtent {
  double u_min = 0, u_max = 0, v_min = 0, v_max = 0;
};

/// Largest distance of a visible slab centre or pixel from the kept part, in voxels.
constexpr double kExtentMargin = 2;

SheetExtent kept_extent(std::span<const VoxelPlane> planes, const Vec3& first, const Vec3& last,
                        const Shear& shear) {
  // List the half spaces of the box and of the cut
  std::vector<VoxelPlane> all;
  for (std::size_t a = 0; a < 3; ++a) {
    for (const double sign : {-1.0, 1.0}) {
      VoxelPlane side;
      side.normal = {0, 0, 0};
      side.normal[a] = sign;
      side.offset = sign > 0 ? last[a] : -first[a];
      all.push_back(side);
    }
  }
  for (VoxelPlane plane : planes) {
    plane.offset += kExtentMargin;
    all.push_back(plane);
  }

  // Bound the vertices of their intersection
  constexpr double kTolerance = 1e-6, kInfinity = std::numeric_limits<double>::infinity();
  SheetExtent extent{kInfinity, -kInfinity, kInfinity, -kInfinity};
  const auto include = [&](const Vec3& p) {
    for (const VoxelPlane& plane : all) {
      if (plane.distance(p) > kTolerance * (1 + std::abs(plane.offset))) return;
    }
    const double k = p[shear.scan.slice_axis];
    const double u = p[shear.scan.scan_axis] + shear.u_shift(k);
    const double v = p[shear.scan.row_axis] + shear.v_shift(k);
    extent = {std::min(extent.u_min, u), std::max(extent.u_max, u), std::min(extent.v_min, v),
              std::max(extent.v_max, v)};
  };
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t j = i + 1; j < all.size(); ++j) {
      for (std::size_t n = j + 1; n < all.size(); ++n) {
        const Vec3 &a = all[i].normal, &b = all[j].normal, &c = all[n].normal;
        const Vec3 bc = cross(b, c), ca = cross(c, a), ab = cross(a, b);
        const double volume = dot(a, bc);
        if (std::abs(volume) < 1e-9) continue;
        Vec3 p{};
        for (std::size_t axis = 0; axis < 3; ++axis)
          p[axis] = (all[i].offset * bc[axis] + all[j].offset * ca[axis] + all[n].offset * ab[axis]) / volume;
        include(p);
      }
    }
  }
  return extent;
}

/// Extent of a region of the picture, padded for interpolation.
SheetExtent shown_extent(const Shear& shear, const PixelBox& region, bool cubic) {
  const double around = cubic ? 2 : 1;
  const Affine2& map = shear.picture_to_sheet;
  const auto shown = [&](double per_x, double per_y, double origin) {
    const double at = origin + per_x * region.x_first + per_y * region.y_first;
    const double x = per_x * region.width(), y = per_y * region.height();
    return std::pair(at + std::min(x, 0.0) + std::min(y, 0.0) - around,
                     at + std::max(x, 0.0) + std::max(y, 0.0) + around);
  };
  const auto [u_min, u_max] = shown(map.xx, map.xy, map.x0);
  const auto [v_min, v_max] = shown(map.yx, map.yy, map.y0);
  return {u_min, u_max, v_min, v_max};
}

/// The part of a window that shows a region of the picture, with whole blocks of pixels of the window.
SheetWindow part_of_window(const SheetWindow& window, const Shear& shear, const PixelBox& region) {
  SheetWindow part = window;
  const SheetExtent shown = shown_extent(shear, region, window.cubic);
  const auto voxel = [](double at, std::int64_t first, std::int64_t count) {
    return static_cast<std::int64_t>(
        std::clamp(at, static_cast<double>(first), static_cast<double>(first + count)));
  };
  const std::int64_t u = voxel(std::floor(shown.u_min), window.u0, window.columns);
  part.u0 = window.u0 + (u - window.u0) / kBlock * kBlock;
  part.v0 = voxel(std::floor(shown.v_min), window.v0, window.rows);
  part.columns = voxel(std::ceil(shown.u_max) + 1, window.u0, window.columns) - part.u0;
  part.rows = voxel(std::ceil(shown.v_max) + 1, window.v0, window.rows) - part.v0;
  if (part.empty()) part.columns = part.rows = 0;
  return part;
}

/// The window of all footprints of the model that overlap the picture, without those that `planes` remove.
SheetWindow sheet_window(const SpanModel& model, const Shear& shear, const PictureSize& size,
                         const SheetSampling& sampling, std::span<const VoxelPlane> planes) {
  SheetWindow window{sampling};
  if (model.voxels == 0) return window;
  // Bound the voxels' projections; a footprint extends one voxel to each side
  const auto seen = [&](double first, double voxels, double shift_first, double shift_last) {
    return std::pair(first - 1 + std::min(shift_first, shift_last),
                     first + voxels + std::max(shift_first, shift_last));
  };
  const double reach = sampling.parts == 1 ? 0 : 1;  // support of a slice along the principal axis
  const double k_first = static_cast<double>(model.slice_first) - reach;
  const double k_last = static_cast<double>(model.slice_first + model.slice_count - 1) + reach;
  auto [u_min, u_max] = seen(static_cast<double>(model.scan_first), static_cast<double>(model.scan_voxels),
                             shear.u_shift(k_first), shear.u_shift(k_last));
  auto [v_min, v_max] = seen(static_cast<double>(model.row_first), static_cast<double>(model.rows),
                             shear.v_shift(k_first), shear.v_shift(k_last));
  if (!planes.empty()) {
    Vec3 low{}, high{};
    const auto set = [&](std::size_t axis, double first, double last) {
      low[axis] = first;
      high[axis] = last;
    };
    set(shear.scan.scan_axis, static_cast<double>(model.scan_first) - 1,
        static_cast<double>(model.scan_first + model.scan_voxels));
    set(shear.scan.row_axis, static_cast<double>(model.row_first) - 1,
        static_cast<double>(model.row_first + model.rows));
    set(shear.scan.slice_axis, k_first - 1, k_last + 1);
    const SheetExtent kept = kept_extent(planes, low, high, shear);
    u_min = std::max(u_min, kept.u_min);
    u_max = std::min(u_max, kept.u_max);
    v_min = std::max(v_min, kept.v_min);
    v_max = std::min(v_max, kept.v_max);
  }

  const auto [u_low, u_high, v_low, v_high] = shown_extent(shear, PixelBox::of(size), sampling.cubic);
  u_min = std::max(u_min, u_low);
  u_max = std::min(u_max, u_high);
  v_min = std::max(v_min, v_low);
  v_max = std::min(v_max, v_high);
  if (!(u_min < u_max && v_min < v_max)) return window;
  window.u0 = static_cast<std::int64_t>(std::floor(u_min));
  window.v0 = static_cast<std::int64_t>(std::floor(v_min));
  window.columns = static_cast<std::int64_t>(std::ceil(u_max)) - window.u0 + 1;
  window.rows = static_cast<std::int64_t>(std::ceil(v_max)) - window.v0 + 1;
  return window;
}

/// Maximum number of sheet pixels (2 GiB). Larger sheets get a lower resolution.
constexpr std::int64_t kMaxSheetPixels = std::int64_t{1} << 27;
/// Opacity at the depth of a ray: those for depths alone end there.
constexpr float kDepthOpacity = 0.5f;

/// True if a typical selected voxel can be opaque: an optical depth of at least 1. Sharp edges need finer
/// sheets to be independent of the principal axis.
bool has_sharp_edges(const SpanModel& model, const Grid& grid) {
  return model.mean_densest_per_mm * reference_length_mm(grid) >= 1;
}

int sheet_scale(Quality quality, const SheetVolume& volume, bool sharp) {
  const double pixels_per_voxel = std::min(volume.shear.voxel_pixels(), 1e3);
  const auto fine = [&](double wanted, int min_scale, int max_scale) {
    return std::clamp(static_cast<int>(std::ceil(wanted - 0.25)), min_scale, max_scale);
  };
  switch (quality) {
    case Quality::kNormal:
      return sharp ? fine(2.25 * pixels_per_voxel, 1, 6) : fine(1.5 * pixels_per_voxel, 1, 4);
    case Quality::kHigh: return fine((sharp ? 2.5 : 2) * pixels_per_voxel, 2, 8);
    case Quality::kDraft: break;
  }
  return fine(pixels_per_voxel, 1, volume.detail.max_scale);
}

/// Slabs per slice. The error along rays is second order in their thickness.
int slab_parts(Quality quality) {
  switch (quality) {
    case Quality::kNormal: return 4;
    case Quality::kHigh: return 8;
    case Quality::kDraft: break;
  }
  return 1;
}

/// Skew of the sampling weights.
/// Within a slab, a ray moves across the slice by (slope_u, slope_v). It averages the slice with a tent of
/// covariance slope_u * slope_v / 6. A sheet samples the slice at the slab's middle only; skewed weights add
/// the missing covariance. Several slabs per slice sample the tent and exceed its covariance slightly.
float skew_of(const Shear& shear, const SheetSampling& sampling) {
  constexpr double kMaxSkew = 0.25;
  const double missing = sampling.parts == 1 ? 1.0 / 6 : -1.0 / (12 * sampling.parts * sampling.parts);
  const double covariance = shear.slope_u * shear.slope_v * missing * sampling.scale * sampling.scale;
  return static_cast<float>(std::clamp(covariance, -kMaxSkew, kMaxSkew));
}

double bytes_of_sheet(const SheetWindow& window, const SpanModel& model) {
  constexpr double kBytesPerRow = 64;
  const auto rows = static_cast<double>(window.fine_rows());
  const double pixels = (rows + 2) * static_cast<double>(window.fine_columns() + 2);
  return 2 * sizeof(float) * (1 + model.emissions) * pixels + kBytesPerRow * rows;
}

SheetSampling sampling_of(const SheetVolume& volume, Quality quality) {
  const bool sharp = has_sharp_edges(volume.spans.frame(), volume.grid);
  return {sheet_scale(quality, volume, sharp), slab_parts(quality), quality != Quality::kDraft};
}

Result<SheetWindow> choose_window(const SheetVolume& volume, SheetSampling sampling, const PictureSize& size,
                                  std::span<const VoxelPlane> planes) {
  const SpanModel& model = volume.spans.frame();
  while (true) {
    SheetWindow window = sheet_window(model, volume.shear, size, sampling, planes);
    window.skew = skew_of(volume.shear, sampling);
    if (window.empty() || window.fine_rows() <= kMaxSheetPixels / window.fine_columns()) return window;
    if (sampling.scale == 1) {
      return fail(ErrorCode::kLimit,
                  fmt::format("the selection covers {} x {} voxels on the picture, too many for one "
                              "sheet; zoom in or select less",
                              window.columns, window.rows));
    }
    --sampling.scale;
  }
}

}  // namespace

Result<Shear> shear_of(const ParallelView& view, const Grid& grid, const RenderOverrides& overrides) {
  const Shear shear = factorise(view, grid, overrides.principal_axis ? &*overrides.principal_axis : nullptr);
  if (std::abs(shear.slope_u) <= kMaxForcedSlope && std::abs(shear.slope_v) <= kMaxForcedSlope) return shear;
  return fail(ErrorCode::kUsage, "principal axis {}: the view runs along its slices; take another",
              "xyz"[static_cast<std::size_t>(shear.principal)]);
}

Result<RasterScene> SheetFrame::raster_scene_of_view() const {
  return raster_scene(scene_.surfaces, scene_.view.plane, volume_.shear, scene_.grid, scene_.lighting);
}

Result<void> SheetFrame::begin_volume(Picture& picture) {
  SPLATLAS_ASSIGN_OR_RETURN(
      window_, choose_window(volume_, sampling_of(volume_, scene_.options.quality), picture.size, planes()));
  if (scene_.walked) walk(*scene_.walked);
  return {};
}

/// Finds the depths, and the ids where the volume alone shows. One step a slab suffices but in high quality.
void SheetFrame::walk(const RayScene& scene) {
  Stopwatch watch;
  const RenderOptions& options = scene_.options;
  walk_ = cast_options(scene_, scene.grid);
  if (options.quality == Quality::kNormal) walk_.max_steps = 1, walk_.tolerance = 0;
  if (!options.ids) walk_.rays = {};
  walk_.termination_threshold =
      options.ids ? options.termination_threshold.value_or(kMinIdOpacity) : kDepthOpacity;
  walk_.cuts = cuts();
  walk_.faces = faces();
  walk_.ids = options.ids ? &buffers_.ids : nullptr;
  walk_.depths = needs_depths() ? &buffers_.depths : nullptr;
  cast_rays(scene.volume, scene_.view, scene.grid, walk_, kernels(), nullptr, pool_);
  stats_.ids += watch.lap();
}

Result<void> SheetFrame::resolve(const PixelBox& region, Picture& picture) {
  Stopwatch watch;
  render_sheet(part_of_window(window_, volume_.shear, region));
  stats_.sheets += watch.lap();
  splatlas::resolve(buffers_.sheet, volume_.shear, {buffers_.fragments, buffers_.in_sheet.samples(), faces()},
                    region, scene_.overrides.simd ? best_warp() : scalar_warp(), paints_surfaces(), picture,
                    pool_);
  stats_.resolve += watch.lap();
  if (scene_.options.ids) {
    cast_surfaces(scene_.walked->volume, scene_.view, scene_.grid, *raster_, buffers_.fragments, walk_,
                  kernels(), nullptr, pool_);
  }
  stats_.ids += watch.lap();
  return {};
}

void SheetFrame::render_sheet(const SheetWindow& window) {
  const RenderOptions& options = scene_.options;
  const auto& [spans, shear, grid, detail, held] = volume_;
  check_memory(bytes_of_sheet(window, spans.frame()));
  const Slabs slabs(shear, grid, window.parts);
  SheetSurfaces surfaces{buffers_.fragments, cuts(), options.size, buffers_.in_sheet};
  if (ends_at_surfaces()) {
    buffers_.ends.build(buffers_.surface_depths, options.size, shear, window, slabs, pool_);
    surfaces.ends = &buffers_.ends;
  }
  // The positive weights of the cubic kernel sum to at most 1.28, which amplifies the error of the sheet.
  const float threshold = termination_threshold(options) / (window.cubic ? 1.3f : 1.0f);
  const SplatKernels kernels = scene_.overrides.simd ? best_kernels() : scalar_kernels();
  stats_.voxels_visited += render_sheets(spans, shear, window, kernels, threshold, planes(), slabs, surfaces,
                                         buffers_.sheet, pool_);
}

}  // namespace splatlas
