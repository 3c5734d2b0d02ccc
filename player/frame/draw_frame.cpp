#include "player/frame/draw_frame.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "format/system/result_macros.h"
#include "player/sheets/resolve.h"
#include "player/sheets/splat_kernels.h"

namespace splatlas {
namespace {

/// A sheet never has more pixels than this (2 GiB); a finer one is made coarser.
constexpr std::int64_t kMaxSheetPixels = std::int64_t{1} << 27;

/// What the rasteriser and the volume pass keep for a fragment, and for a sample with only one.
constexpr std::size_t kBytesPerFragment = 200;
/// What finding edges takes for a pixel.
constexpr std::uint64_t kBytesToFindEdges = 48;
/// Their numbers have 32 bits.
constexpr std::size_t kMaxFragments = 0xfffffffe;

/// Whether most of what is selected can hide what is behind it within a voxel: its edges are sharp then, and
/// take more pixels to look the same from all sides.
bool has_sharp_edges(const SpanModel& model, const Grid& grid) {
  return model.mean_densest_per_mm * reference_length_mm(grid) >= 1;
}

int sheet_scale(Quality quality, const Shear& shear, bool sharp) {
  const Affine2& map = shear.picture_to_sheet;
  const double voxels_per_pixel = std::min(std::hypot(map.xx, map.yx), std::hypot(map.xy, map.yy));
  const double pixels_per_voxel = std::min(1.0 / voxels_per_pixel, 1e3);
  const auto fine = [&](double wanted, int least, int most) {
    return std::clamp(static_cast<int>(std::ceil(wanted - 0.25)), least, most);
  };
  switch (quality) {
    case Quality::kNormal:
      return sharp ? fine(2.25 * pixels_per_voxel, 1, 6) : fine(1.5 * pixels_per_voxel, 1, 4);
    case Quality::kHigh: return fine((sharp ? 2.5 : 2) * pixels_per_voxel, 2, 8);
    case Quality::kDraft: break;
  }
  return fine(pixels_per_voxel, 1, 2);
}

/// Slabs per slice. The error along rays falls with their square.
int slab_parts(Quality quality) {
  switch (quality) {
    case Quality::kNormal: return 4;
    case Quality::kHigh: return 8;
    case Quality::kDraft: break;
  }
  return 1;
}

/// Along a slab a ray moves across the slice by (slope_u, slope_v), which smears what the slice shows: a tent
/// of that length, whose covariance is a sixth of the product. Sheets know the slice at the slab's middle
/// only; weights that are skewed smear as much where the sheet is sampled. Slabs between slices are samples
/// of that tent, and smear a little too much.
float skew_of(const Shear& shear, const SheetSampling& sampling) {
  constexpr double kMost = 0.25;
  const double missing = sampling.parts == 1 ? 1.0 / 6 : -1.0 / (12 * sampling.parts * sampling.parts);
  const double covariance = shear.slope_u * shear.slope_v * missing * sampling.scale * sampling.scale;
  return static_cast<float>(std::clamp(covariance, -kMost, kMost));
}

/// The cubic's weights above 0 add up to 1.28 at most: what sheets leave out may grow by that.
float threshold_of(const RenderOptions& options, const SheetWindow& window) {
  return termination_threshold(options) / (window.cubic ? 1.3f : 1.0f);
}

std::size_t edge_samples(const RenderOptions& options, std::uint64_t max_memory_bytes) {
  if (!options.antialiasing || options.quality == Quality::kDraft) return 1;
  const auto pixels =
      static_cast<std::uint64_t>(options.size.width) * static_cast<std::uint64_t>(options.size.height);
  if (pixels > max_memory_bytes / 4 / kBytesToFindEdges) return 1;
  return options.quality == Quality::kNormal ? kFourSamples.size() : kEightSamples.size();
}

Result<SheetWindow> choose_window(const SpanModel& model, const Shear& shear, const Grid& grid,
                                  const RenderOptions& options) {
  SheetSampling sampling{sheet_scale(options.quality, shear, has_sharp_edges(model, grid)),
                         slab_parts(options.quality), options.quality != Quality::kDraft};
  while (true) {
    SheetWindow window = sheet_window(model, shear, options.size, sampling);
    window.skew = skew_of(shear, sampling);
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

RasterOptions raster_options(const RenderOptions& options, std::uint64_t max_memory_bytes) {
  const std::size_t max_fragments =
      std::min<std::size_t>(max_memory_bytes / 4 / kBytesPerFragment, kMaxFragments);
  return {max_fragments, termination_threshold(options), edge_samples(options, max_memory_bytes)};
}

Result<FrameCounters> draw_frame(const FrameRequest& frame, FrameBuffers& buffers, Picture& picture,
                                 ThreadPool& pool) {
  const RenderOptions& options = frame.options;
  FrameCounters counters;
  Stopwatch watch;
  const RasterScene scene = raster_scene(frame.surfaces, frame.view, frame.shear, frame.grid, frame.lighting);
  SPLATLAS_ASSIGN_OR_RETURN(const RasterCounters raster,
                            buffers.rasterizer.draw(scene, raster_options(options, frame.max_memory_bytes),
                                                    buffers.fragments, pool));
  counters.triangles = raster.triangles;
  counters.rasterize = watch.lap();

  SPLATLAS_ASSIGN_OR_RETURN(const SheetWindow window,
                            choose_window(frame.spans, frame.shear, frame.grid, options));
  const SplatKernels& kernels = frame.simd ? best_kernels() : scalar_kernels();
  buffers.order.build(buffers.fragments, frame.shear, window, options.size, frame.grid, pool);
  const SheetCounters sheets =
      render_sheets(frame.spans, frame.shear, window, kernels, threshold_of(options, window), buffers.order,
                    buffers.sheet, pool);
  counters.voxels = sheets.voxels;
  counters.sheets = watch.lap();

  resolve(buffers.sheet, frame.shear, {buffers.fragments, buffers.order}, options.size,
          frame.simd ? best_warp() : scalar_warp(), picture, pool);
  counters.resolve = watch.lap();
  return counters;
}

}  // namespace splatlas
