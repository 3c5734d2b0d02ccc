#include "player/frame/frame_renderer.h"

#include <algorithm>

#include "format/system/result_macros.h"
#include "player/frame/stopwatch.h"
#include "player/rays/cast_surfaces.h"

namespace splatlas {
namespace {

/// Bytes of the rasteriser and the volume pass per fragment, for samples with a single fragment.
constexpr std::size_t kBytesPerFragment = 200;
/// Bytes per pixel of edge detection.
constexpr std::uint64_t kBytesToFindEdges = 48;
/// Maximum of 32-bit fragment indices.
constexpr std::size_t kMaxFragments = 0xfffffffe;
constexpr std::size_t kRowsPerJob = 16;

std::uint64_t pixels_of(const PictureSize& size) {
  return static_cast<std::uint64_t>(size.width) * static_cast<std::uint64_t>(size.height);
}

bool cues_depth(const RenderOptions& options) {
  return options.depth_cue == DepthCue::kEdges && options.depth_cue_strength > 0;
}

/// Samples per edge pixel and maximum number of fragments, which may take a quarter of the memory.
RasterOptions raster_options(const RenderOptions& options, std::uint64_t max_memory_bytes) {
  const std::uint64_t max_bytes = max_memory_bytes / 4;
  RasterOptions raster{std::min<std::size_t>(max_bytes / kBytesPerFragment, kMaxFragments),
                       termination_threshold(options)};
  const bool supersamples = options.antialiasing && pixels_of(options.size) <= max_bytes / kBytesToFindEdges;
  if (supersamples && options.quality == Quality::kNormal) raster.edge_samples = kFourSamples.size();
  if (supersamples && options.quality == Quality::kHigh) raster.edge_samples = kEightSamples.size();
  return raster;
}

}  // namespace

std::uint64_t frame_bytes(const RenderOptions& options) {
  return picture_bytes(options.size) + (cues_depth(options) ? pixels_of(options.size) * sizeof(float) : 0);
}

Result<void> FrameRenderer::rasterize() {
  Stopwatch watch;
  SPLATLAS_ASSIGN_OR_RETURN(const RasterScene raster, raster_scene_of_view());
  raster_.emplace(raster);
  SPLATLAS_ASSIGN_OR_RETURN(
      stats_.triangles,
      buffers_.rasterizer.draw(*raster_, raster_options(scene_.options, scene_.max_memory_bytes),
                               buffers_.fragments, pool_));
  stats_.rasterize = watch.lap();
  return {};
}

void FrameRenderer::cue_depth(Picture& picture) {
  Stopwatch watch;
  if (cues_depth(scene_.options)) {
    const ViewDepth view_depth(scene_.view, scene_.grid);
    buffers_.depths.clear(scene_.options.size);
    add_surface_depths(buffers_.fragments, shown(), view_depth, buffers_.depths, pool_);
    add_volume_depths(view_depth);
    darken_edges(buffers_.depths, depth_edges(scene_.view.plane, scene_.options.depth_cue_strength), picture,
                 pool_);
  }
  stats_.depth_cue = watch.lap();
}

ShownFrame FrameRenderer::shown() const {
  return {scene_.view, slice_axis(), raster_->depth_axis, raster_->depth_sign,
          raster_options(scene_.options, scene_.max_memory_bytes)};
}

Result<void> rasterize_again(const ShownFrame& frame, std::span<const SurfaceDraw> surfaces, const Grid& grid,
                             FrameBuffers& buffers, ThreadPool& pool) {
  const ParallelView& plane = frame.view.plane;
  const Lighting lighting(plane);
  SPLATLAS_ASSIGN_OR_RETURN(
      const RasterScene scene,
      frame.sheets ? raster_scene(surfaces, plane, factorise(plane, grid, &*frame.sheets), grid, lighting)
                   : raster_scene_of_rays(surfaces, frame.view, grid, lighting));
  SPLATLAS_RETURN_IF_ERROR(buffers.rasterizer.draw(scene, frame.raster, buffers.fragments, pool));
  return {};
}

void add_surface_depths(const FragmentList& fragments, const ShownFrame& frame, const ViewDepth& view,
                        DepthMap& depths, ThreadPool& pool) {
  const int width = depths.size.width;
  const std::size_t rows = fragments.first_of_row.size() - 1;
  pool.for_each((rows + kRowsPerJob - 1) / kRowsPerJob, [&](std::size_t job) {
    const std::size_t end = fragments.first_of_row[std::min(rows, (job + 1) * kRowsPerJob)];
    for (std::size_t n = fragments.first_of_row[job * kRowsPerJob]; n < end; ++n) {
      const Sample& sample = fragments.samples[n];
      float transmittance = 1;
      for (const Fragment& fragment : fragments.of_sample(n)) {
        transmittance *= 1 - fragment.rgba[3];
        if (transmittance > 0.5f) continue;
        const auto mm = static_cast<float>(
            view.mm(sample.x(width), sample.y(width), frame.depth_axis, frame.depth_sign * fragment.depth));
        depths.mm[sample.pixel] = std::min(depths.mm[sample.pixel], mm);
        break;
      }
    }
  });
}

}  // namespace splatlas
