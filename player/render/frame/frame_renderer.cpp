#include "player/render/frame/frame_renderer.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "format/result_macros.h"
#include "player/render/frame/draft_pace.h"
#include "player/render/frame/stopwatch.h"
#include "player/render/rays/cast_surfaces.h"

namespace splatlas {
namespace {

/// Progress of a frame at the end of each stage.
constexpr double kRasterized = 0.4, kVolumeDrawn = 0.9, kResolved = 0.95;
/// Number of loops that report progress.
constexpr std::size_t kRasterLoops = 8, kResolveLoops = 2, kCueLoops = 4;

/// Bytes of the rasteriser and the volume pass per fragment, for samples with a single fragment.
constexpr std::size_t kBytesPerFragment = 200;
/// Bytes per pixel of edge detection.
constexpr std::uint64_t kBytesToFindEdges = 48;
/// Maximum of 32-bit fragment indices.
constexpr std::size_t kMaxFragments = 0xfffffffe;
/// Bytes per pixel of id images, and of the shares of structures.
constexpr std::uint64_t kBytesOfIds = 2 * sizeof(StructureNumber) + 60;
constexpr std::size_t kRowsPerJob = 16;

std::uint64_t pixels_of(const PictureSize& size) {
  return static_cast<std::uint64_t>(size.width) * static_cast<std::uint64_t>(size.height);
}

/// Distance from a cutting plane, in voxels, within which surfaces are removed: its face covers them.
constexpr double kCutMargin = 1.0 / 4096;

/// Finds the faces of a cut at the samples of fragments.
void find_sample_faces(const ViewFaces& faces, int width, FragmentList& list, ThreadPool& pool) {
  constexpr std::size_t kSamplesPerJob = 1024;
  list.faces.resize(list.sample_count());
  pool.for_each((list.sample_count() + kSamplesPerJob - 1) / kSamplesPerJob, [&](std::size_t job) {
    const std::size_t end = std::min(list.sample_count(), (job + 1) * kSamplesPerJob);
    for (std::size_t n = job * kSamplesPerJob; n < end; ++n)
      list.faces[n] = faces.through(list.samples[n].x(width), list.samples[n].y(width));
  });
}

/// Rasterises surfaces, clipped by the frame's cut, and finds the faces of the cut. `painted`: the picture to
/// paint in place of fragments, behind the faces, and its `depths`; null: none. Returns the number of
/// triangles.
Result<std::uint64_t> draw_surfaces(RasterScene scene, const ShownFrame& frame, const Grid& grid,
                                    FrameBuffers& buffers, Picture* painted, std::vector<float>* depths,
                                    ThreadPool& pool) {
  if (frame.faces == nullptr) buffers.faces.clear();
  buffers.fragments.faces.clear();
  buffers.has_fragments = painted == nullptr;
  std::optional<CutRays> surface_cuts;
  if (!frame.cuts.empty()) scene.cuts = &surface_cuts.emplace(frame.cuts, frame.view, grid, kCutMargin);
  std::optional<CutRays> cuts;
  std::optional<ViewFaces> faces;
  if (frame.faces != nullptr) {
    cuts.emplace(frame.cuts, frame.view, grid);
    faces.emplace(*frame.faces, *cuts, frame.caps, frame.depth_axis, frame.depth_sign);
    fill_faces(*faces, scene.size, buffers.faces, pool);
    scene.faces = &buffers.faces;
  }
  if (painted != nullptr) {
    buffers.fragments.clear(scene.size);
    return buffers.rasterizer.paint(scene, frame.raster, *painted, depths, pool);
  }
  if (!faces) return buffers.rasterizer.draw(scene, frame.raster, buffers.fragments, pool);
  SPLATLAS_ASSIGN_OR_RETURN(const std::uint64_t triangles,
                            buffers.rasterizer.draw(scene, frame.raster, buffers.fragments, pool));
  find_sample_faces(*faces, scene.size.width, buffers.fragments, pool);
  return triangles;
}

bool cues_depth(const RenderOptions& options) {
  return options.depth_cue == DepthCue::kEdges && options.depth_cue_strength > 0;
}

/// Samples per edge pixel and maximum number of fragments, which may take half of the memory.
RasterOptions raster_options(const RenderOptions& options, std::uint64_t max_memory_bytes) {
  RasterOptions raster{std::min<std::size_t>(max_memory_bytes / 2 / kBytesPerFragment, kMaxFragments),
                       termination_threshold(options)};
  const bool supersamples =
      options.antialiasing && pixels_of(options.size) <= max_memory_bytes / 4 / kBytesToFindEdges;
  if (supersamples && options.quality == Quality::kNormal) raster.edge_samples = kFourSamples.size();
  if (supersamples && options.quality == Quality::kHigh) raster.edge_samples = kEightSamples.size();
  return raster;
}

}  // namespace

bool shows_faces(const RenderOptions& options) {
  return !options.cuts.empty() && options.caps != CapMode::kNone;
}

std::uint64_t frame_bytes(const RenderOptions& options) {
  std::uint64_t bytes_per_pixel = cues_depth(options) ? sizeof(float) : 0;
  if (options.depths) bytes_per_pixel += 2 * sizeof(float);
  if (shows_faces(options)) bytes_per_pixel += sizeof(RayFaces);
  if (options.ids) bytes_per_pixel += kBytesOfIds;
  return picture_bytes(options.size) + pixels_of(options.size) * bytes_per_pixel;
}

Result<void> check_size(const RenderOptions& options, std::uint64_t max_memory_bytes) {
  const std::uint64_t bytes = frame_bytes(options);
  if (bytes <= max_memory_bytes) return {};
  return fail(ErrorCode::kLimit,
              "a picture of {}x{} pixels takes {} MiB; {} MiB are allowed. Take a smaller size",
              options.size.width, options.size.height, bytes >> 20, max_memory_bytes >> 20);
}

Result<void> check_ids(const RenderOptions& options, const Atlas& atlas) {
  if (!options.ids || atlas.graph().size() <= kMaxNumberedStructures) return {};
  return fail(ErrorCode::kUsage,
              fmt::format("{}: the atlas has {} structures; id images number at most {}. Render without ids",
                          atlas.name(), atlas.graph().size(), kMaxNumberedStructures));
}

FrameRenderer::FrameRenderer(const FrameScene& scene, FrameBuffers& buffers, RenderStats& stats,
                             ThreadPool& pool)
    : scene_(scene), buffers_(buffers), stats_(stats), pool_(pool) {
  if (!scene.options.cuts.empty()) cuts_.emplace(scene.options.cuts, scene.view, scene.grid);
}

Result<void> FrameRenderer::run(std::size_t volume_loops, TaskControl& task, Picture& picture) {
  stats_.voxels_visited = 0;
  stats_.sheets = stats_.resolve = stats_.ids = stats_.depth_cue = {};
  task.begin_stage(kRasterized, kRasterLoops);
  SPLATLAS_RETURN_IF_ERROR(rasterize(picture));
  if (voxels() == 0 && paints_surfaces()) {
    if (faces() != nullptr) add_faces(*faces(), picture, pool_);
    return {};
  }
  task.begin_stage(kVolumeDrawn, volume_loops);
  SPLATLAS_RETURN_IF_ERROR(render_volume(picture));
  task.begin_stage(kResolved, kResolveLoops);
  resolve(picture);
  resolve_ids(picture);
  task.begin_stage(1, kCueLoops);
  measure_depths();
  cue_depth(picture);
  return {};
}

/// True if no fragments are needed: without a volume, or with one whose rays end at opaque surfaces. Rays
/// round the transmittance of translucent surfaces in another way. Faces need them for their samples at
/// edges, which drafts do not have.
bool FrameRenderer::paints_surfaces() const {
  const RenderOptions& options = scene_.options;
  const bool alone = voxels() == 0 && (slice_axis() || all_opaque());
  return (alone || ends_at_surfaces()) && (scene_.faces == nullptr || options.quality == Quality::kDraft) &&
         !options.ids && !options.depths && !cues_depth(options);
}

bool FrameRenderer::ends_at_surfaces() const {
  return may_be_rough(scene_.options) && voxels() > 0 && !scene_.surfaces.empty() && all_opaque();
}

bool FrameRenderer::all_opaque() const {
  return std::ranges::all_of(scene_.surfaces, [](const SurfaceDraw& surface) { return surface.is_opaque(); });
}

Result<void> FrameRenderer::rasterize(Picture& picture) {
  Stopwatch watch;
  SPLATLAS_ASSIGN_OR_RETURN(const RasterScene raster, raster_scene_of_view());
  raster_.emplace(raster);
  SPLATLAS_ASSIGN_OR_RETURN(
      stats_.triangles,
      draw_surfaces(*raster_, shown(), scene_.grid, buffers_, paints_surfaces() ? &picture : nullptr,
                    ends_at_surfaces() ? &buffers_.surface_depths : nullptr, pool_));
  stats_.rasterize = watch.lap();
  return {};
}

void FrameRenderer::scale_depths(int level) {
  if (level == 0) return;
  const double scale = std::ldexp(1.0, -level);
  const double shift = raster_->depth_sign * (scale - 1) / 2;
  const auto scaled = [&](float depth) {
    return static_cast<float>(scale * static_cast<double>(depth) + shift);
  };
  for (float& depth : buffers_.surface_depths) depth = scaled(depth);
  for (Fragment& fragment : buffers_.fragments.fragments) fragment.depth = scaled(fragment.depth);
  buffers_.has_fragments = false;
}

void FrameRenderer::measure_depths() {
  Stopwatch watch;
  if (scene_.options.depths || cues_depth(scene_.options)) {
    const ViewDepth view_depth(scene_.view, scene_.grid);
    buffers_.depths.clear(scene_.options.size);
    add_surface_depths(buffers_.fragments, buffers_.faces, shown(), view_depth, buffers_.depths, pool_);
    add_volume_depths(view_depth);
  }
  stats_.depth_cue = watch.lap();
}

void FrameRenderer::cue_depth(Picture& picture) {
  if (!cues_depth(scene_.options)) return;
  Stopwatch watch;
  darken_edges(buffers_.depths, depth_edges(scene_.view.plane, scene_.options.depth_cue_strength), picture,
               pool_);
  stats_.depth_cue += watch.lap();
}

ShownFrame FrameRenderer::shown() const {
  return {scene_.view,
          slice_axis(),
          raster_->depth_axis,
          raster_->depth_sign,
          raster_options(scene_.options, scene_.max_memory_bytes),
          scene_.options.cuts,
          scene_.options.caps,
          scene_.faces,
          stats_.surface_level};
}

Result<void> rasterize_again(const ShownFrame& frame, std::span<const SurfaceDraw> surfaces, const Grid& grid,
                             FrameBuffers& buffers, ThreadPool& pool) {
  const ParallelView& plane = frame.view.plane;
  const Lighting lighting(plane);
  SPLATLAS_ASSIGN_OR_RETURN(
      const RasterScene scene,
      frame.sheets ? raster_scene(surfaces, plane, factorise(plane, grid, &*frame.sheets), grid, lighting)
                   : raster_scene_of_rays(surfaces, frame.view, grid, lighting));
  SPLATLAS_RETURN_IF_ERROR(draw_surfaces(scene, frame, grid, buffers, nullptr, nullptr, pool));
  return {};
}

void add_surface_depths(const FragmentList& fragments, const FaceLayer& faces, const ShownFrame& frame,
                        const ViewDepth& view, DepthMap& depths, ThreadPool& pool) {
  const int width = depths.size.width;
  const auto include = [&](std::size_t pixel, double x, double y, float depth) {
    const auto mm =
        static_cast<float>(view.mm(x, y, frame.depth_axis, frame.depth_sign * static_cast<double>(depth)));
    depths.mm[pixel] = std::min(depths.mm[pixel], mm);
  };
  // Find the depths of fragments and of faces around them
  const std::size_t rows = fragments.first_of_row.size() - 1;
  pool.for_each((rows + kRowsPerJob - 1) / kRowsPerJob, [&](std::size_t job) {
    const std::size_t end = fragments.first_of_row[std::min(rows, (job + 1) * kRowsPerJob)];
    for (std::size_t n = fragments.first_of_row[job * kRowsPerJob]; n < end; ++n) {
      const Sample& sample = fragments.samples[n];
      float transmittance = fragments.faces.empty() ? 1 : 1 - fragments.faces[n].front.rgba[3];
      for (const Fragment& fragment : fragments.of_sample(n)) {
        if (transmittance <= 0.5f) break;
        transmittance *= 1 - fragment.rgba[3];
        if (transmittance <= 0.5f) include(sample.pixel, sample.x(width), sample.y(width), fragment.depth);
      }
    }
  });
  if (faces.empty()) return;

  // Find the depths of faces at pixel centres
  const auto columns = static_cast<std::size_t>(width);
  pool.for_each(static_cast<std::size_t>(depths.size.height), [&](std::size_t row) {
    const FaceLayer::Extent shown = faces.shown[row];
    for (auto column = static_cast<std::size_t>(shown.first); column < static_cast<std::size_t>(shown.last);
         ++column) {
      const std::size_t pixel = row * columns + column;
      const RayFaces of_pixel = faces.at(pixel);
      const auto& [front, back] = of_pixel;
      const double x = static_cast<double>(column) + 0.5, y = static_cast<double>(row) + 0.5;
      if (front.rgba[3] >= 0.5f) {
        include(pixel, x, y, front.depth);
      } else if ((1 - front.rgba[3]) * (1 - back.rgba[3]) <= 0.5f) {
        include(pixel, x, y, back.depth);
      }
    }
  });
}

}  // namespace splatlas
