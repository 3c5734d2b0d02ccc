#include "player/render/frame/sheet_frame.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "format/result_macros.h"
#include "format/tasks/task_control.h"
#include "player/render/contributions/pixel_shares.h"
#include "player/render/frame/ray_frame.h"
#include "player/render/frame/stopwatch.h"
#include "player/render/rays/cast_surfaces.h"
#include "player/render/sheets/footprint_window.h"
#include "player/render/sheets/sheets.h"
#include "player/render/sheets/splat/splat_kernels.h"

namespace splatlas {
namespace {

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
  const auto& [spans, shear, grid, detail] = volume_;
  check_memory(bytes_of_sheet(window, spans.frame()));
  const Slabs slabs(shear, grid, window.parts);
  SheetSurfaces surfaces{buffers_.fragments, cuts(), options.size, buffers_.in_sheet};
  if (ends_at_surfaces()) {
    buffers_.ends.build(buffers_.surface_depths, options.size, shear, window, slabs, pool_);
    surfaces.ends = &buffers_.ends;
  }
  // The positive weights of the cubic kernel sum to at most 1.28, which amplifies the error of the sheet.
  const float threshold = termination_threshold(options) / (window.cubic ? 1.3f : 1.0f);
  const SplatKernels& kernels = scene_.overrides.simd ? best_kernels() : scalar_kernels();
  stats_.voxels_visited += render_sheets(spans, shear, window, kernels, threshold, planes(), slabs, surfaces,
                                         buffers_.sheet, pool_);
}

}  // namespace splatlas
