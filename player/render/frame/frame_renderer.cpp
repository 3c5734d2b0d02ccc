#include "player/render/frame/frame_renderer.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "format/result_macros.h"
#include "player/render/frame/draft_pace.h"
#include "player/render/frame/stopwatch.h"

namespace splatlas {
namespace {

/// Progress of a frame at the end of each stage.
constexpr double kBegun = 0.3, kResolved = 0.95;
constexpr std::size_t kRasterLoops = 8, kResolveLoops = 2, kCueLoops = 4;
/// Pixels of a region with fragments, in whole tiles of the warp. Larger ones take more memory; smaller ones
/// draw more of the volume twice, at their borders. Opaque surfaces leave few fragments.
constexpr std::int32_t kRegionWidth = 512, kRegionHeight = 256, kOpaqueRegion = 1024;

/// Bytes of the rasteriser and the volume pass per fragment, for samples with a single fragment.
constexpr std::size_t kBytesPerFragment = 200;
constexpr std::uint64_t kBytesToFindEdges = 48;
/// Maximum of 32-bit fragment indices.
constexpr std::size_t kMaxFragments = 0xfffffffe;
constexpr std::size_t kRowsPerJob = 16;

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

/// Clips the surfaces of the scene by the frame's cut, and finds the faces of the cut in the scene's region.
void add_cuts(const ShownFrame& frame, const Grid& grid, FaceLayer& layer, SurfaceCuts& cuts,
              RasterScene& scene, ThreadPool& pool) {
  if (!frame.cuts.empty()) scene.cuts = &cuts.surfaces.emplace(frame.cuts, frame.view, grid, kCutMargin);
  if (frame.faces == nullptr) {
    layer = {};
    return;
  }
  cuts.of_faces.emplace(frame.cuts, frame.view, grid);
  cuts.faces.emplace(*frame.faces, *cuts.of_faces, frame.caps, frame.depth_axis, frame.depth_sign);
  fill_faces(*cuts.faces, scene.size, scene.region, layer, pool);
  scene.faces = &layer;
  scene.sample_faces = &*cuts.faces;
}

/// Rasterises the fragments of the scene's region, with the faces of the cut at their samples.
Result<std::uint64_t> draw_fragments(const RasterScene& scene, const RasterOptions& options,
                                     const SurfaceCuts& cuts, FrameBuffers& buffers, ThreadPool& pool) {
  buffers.fragments.faces.clear();
  SPLATLAS_ASSIGN_OR_RETURN(const std::uint64_t triangles,
                            buffers.rasterizer.draw(scene, options, buffers.fragments, pool));
  if (cuts.faces) find_sample_faces(*cuts.faces, scene.size.width, buffers.fragments, pool);
  return triangles;
}

bool cues_depth(const RenderOptions& options) {
  return options.depth_cue == DepthCue::kEdges && options.depth_cue_strength > 0;
}

/// Samples per edge pixel and maximum number of fragments, which may take half of the memory.
RasterOptions raster_options(const RenderOptions& options, std::uint64_t max_memory_bytes) {
  RasterOptions raster{std::min<std::size_t>(max_memory_bytes / 2 / kBytesPerFragment, kMaxFragments),
                       termination_threshold(options)};
  if (options.antialiasing && options.quality == Quality::kNormal) raster.edge_samples = kFourSamples.size();
  if (options.antialiasing && options.quality == Quality::kHigh) raster.edge_samples = kEightSamples.size();
  return raster;
}

/// The halves of a region of more than one pixel, along whole tiles if it has any.
std::array<PixelBox, 2> halves(const PixelBox& region) {
  constexpr std::int32_t kTile = TileBins::kTileSide;
  const std::int32_t pixels = std::max(region.width(), region.height());
  const std::int32_t half = pixels > kTile ? (pixels / kTile + 1) / 2 * kTile : pixels / 2;
  std::array<PixelBox, 2> parts{region, region};
  if (region.width() == pixels) {
    parts[0].x_last = (parts[1].x_first = region.x_first + half) - 1;
  } else {
    parts[0].y_last = (parts[1].y_first = region.y_first + half) - 1;
  }
  return parts;
}

/// Merges the depth of a sample of a pixel into a depth map.
auto depth_merger(const ShownFrame& frame, const ViewDepth& view, DepthMap& depths) {
  return [&](std::size_t pixel, double x, double y, float depth) {
    const auto mm =
        static_cast<float>(view.mm(x, y, frame.depth_axis, frame.depth_sign * static_cast<double>(depth)));
    depths.mm[pixel] = std::min(depths.mm[pixel], mm);
  };
}

/// Merges the depths of the faces of cuts into `depths`, as add_surface_depths(). O(pixels).
void add_face_depths(const FaceLayer& faces, const ShownFrame& frame, const ViewDepth& view, DepthMap& depths,
                     ThreadPool& pool) {
  if (faces.empty()) return;
  const auto include = depth_merger(frame, view, depths);
  pool.for_each(static_cast<std::size_t>(depths.size.height), [&](std::size_t row) {
    const FaceLayer::Extent shown = faces.shown[row];
    for (std::int32_t column = shown.first; column < shown.last; ++column) {
      const std::size_t pixel = depths.size.pixel(column, static_cast<int>(row));
      const RayFaces of_pixel = faces.at(pixel);
      const auto& [front, back] = of_pixel;
      const double x = column + 0.5, y = static_cast<double>(row) + 0.5;
      if (front.rgba[3] >= 0.5f) {
        include(pixel, x, y, front.depth);
      } else if ((1 - front.rgba[3]) * (1 - back.rgba[3]) <= 0.5f) {
        include(pixel, x, y, back.depth);
      }
    }
  });
}

}  // namespace

bool shows_faces(const RenderOptions& options) {
  return !options.cuts.empty() && options.caps != CapMode::kNone;
}

std::uint64_t frame_bytes(const RenderOptions& options) {
  std::uint64_t bytes_per_pixel = cues_depth(options) ? sizeof(float) : 0;
  if (options.depths) bytes_per_pixel += 2 * sizeof(float);
  if (shows_faces(options)) bytes_per_pixel += sizeof(RayFaces);
  if (options.ids) bytes_per_pixel += 2 * sizeof(StructureNumber);
  return picture_bytes(options.size) + options.size.pixels() * bytes_per_pixel;
}

Result<void> check_size(const RenderOptions& options, std::uint64_t max_memory_bytes) {
  const std::uint64_t bytes = frame_bytes(options);
  if (bytes <= max_memory_bytes) return {};
  return fail(ErrorCode::kLimit,
              "a picture of {}x{} pixels takes {} MiB; {} MiB are allowed. Take a smaller size",
              options.size.width, options.size.height, bytes >> 20, max_memory_bytes >> 20);
}

bool walks_rays(const RenderOptions& options) {
  return options.ids || options.depths || cues_depth(options);
}

Result<void> check_ids(const RenderOptions& options, const Atlas& atlas) {
  if (!options.ids || atlas.graph().size() <= kMaxNumberedStructures) return {};
  return fail(ErrorCode::kUsage,
              fmt::format("{}: the atlas has {} structures; id images number at most {}. Render without ids",
                          atlas.name(), atlas.graph().size(), kMaxNumberedStructures));
}

FrameRenderer::FrameRenderer(const FrameScene& scene, const Grid& of_volume, FrameBuffers& buffers,
                             RenderStats& stats, ThreadPool& pool)
    : scene_(scene), buffers_(buffers), stats_(stats), pool_(pool) {
  if (!scene.options.cuts.empty()) cuts_.emplace(scene.options.cuts, scene.view, of_volume);
}

Result<void> FrameRenderer::run(std::size_t volume_loops, TaskControl& task, Picture& picture) {
  const PictureSize& size = scene_.options.size;
  stats_.voxels_visited = 0;
  stats_.rasterize = stats_.sheets = stats_.resolve = stats_.ids = stats_.depth_cue = {};
  picture.size = size;
  picture.rgba.resize(4 * size.pixels());
  if (needs_depths()) buffers_.depths.clear(size);

  // Draw what is not drawn by regions
  task.begin_stage(kBegun, kRasterLoops + volume_loops);
  SPLATLAS_RETURN_IF_ERROR(begin_surfaces(picture));
  if (voxels() == 0 && paints_surfaces()) return {};
  SPLATLAS_RETURN_IF_ERROR(begin_volume(picture));

  // Draw all regions; one without fragments but of faces, which are few
  const PixelBox whole = PixelBox::of(size);
  const bool has_fragments = !paints_surfaces() && !scene_.surfaces.empty();
  const std::int32_t width = !has_fragments ? size.width : all_opaque() ? kOpaqueRegion : kRegionWidth;
  const std::int32_t height = !has_fragments ? size.height : all_opaque() ? kOpaqueRegion : kRegionHeight;
  const std::int32_t columns = (size.width + width - 1) / width, rows = (size.height + height - 1) / height;
  for (std::int32_t n = 0; n < columns * rows; ++n) {
    task.begin_stage(kBegun + (kResolved - kBegun) * (n + 1) / (columns * rows),
                     kRasterLoops + volume_loops + kResolveLoops);
    const std::int32_t x = n % columns * width, y = n / columns * height;
    SPLATLAS_RETURN_IF_ERROR(
        draw_region(intersection(whole, {x, x + width - 1, y, y + height - 1}), picture));
  }
  Stopwatch watch;
  if (scene_.options.ids) fit_ids(picture, buffers_.ids);
  stats_.ids += watch.lap();
  task.begin_stage(1, kCueLoops);
  finish_depths(picture);
  return {};
}

/// Converts a depth into voxels of the volume's level.
auto FrameRenderer::depth_converter() const {
  const double scale = std::ldexp(1.0, -level()), offset = raster_->depth_sign * (scale - 1) / 2;
  return [=](float depth) { return static_cast<float>(scale * static_cast<double>(depth) + offset); };
}

/// Paints the surfaces into the picture, if nothing needs their fragments.
Result<void> FrameRenderer::begin_surfaces(Picture& picture) {
  Stopwatch watch;
  SPLATLAS_ASSIGN_OR_RETURN(const RasterScene raster, raster_scene_of_view());
  raster_.emplace(raster);
  add_cuts(shown(), scene_.grid, buffers_.faces, surface_cuts_, *raster_, pool_);
  buffers_.picked = {};
  buffers_.fragments.clear(scene_.options.size);
  buffers_.fragments.faces.clear();
  if (paints_surfaces()) {
    SPLATLAS_ASSIGN_OR_RETURN(
        stats_.triangles,
        buffers_.rasterizer.paint(*raster_, shown().raster, picture,
                                  ends_at_surfaces() ? &buffers_.surface_depths : nullptr, pool_));
    if (ends_at_surfaces() && level() > 0)
      std::transform(buffers_.surface_depths.begin(), buffers_.surface_depths.end(),
                     buffers_.surface_depths.begin(), depth_converter());
  }
  stats_.rasterize = watch.lap();
  return {};
}

/// Draws a region, or its halves if its fragments take too much memory.
Result<void> FrameRenderer::draw_region(const PixelBox& region, Picture& picture) {
  Stopwatch watch;
  raster_->region = region;
  if (!paints_surfaces()) {
    const Result<std::uint64_t> triangles =
        draw_fragments(*raster_, shown().raster, surface_cuts_, buffers_, pool_);
    if (!triangles && triangles.error().code == ErrorCode::kLimit && region.pixels() > 1) {
      const auto [first, second] = halves(region);
      SPLATLAS_RETURN_IF_ERROR(draw_region(first, picture));
      return draw_region(second, picture);
    }
    SPLATLAS_ASSIGN_OR_RETURN(stats_.triangles, triangles);
    if (needs_depths()) {
      const ViewDepth view_depth(scene_.view, scene_.grid);
      add_surface_depths(buffers_.fragments, shown(), view_depth, buffers_.depths, pool_);
    }
    const auto converted = depth_converter();
    for (Fragment& fragment : buffers_.fragments.fragments) fragment.depth = converted(fragment.depth);
  }
  stats_.rasterize += watch.lap();
  return resolve(region, picture);
}

/// True if no fragments are needed: without a volume, or with one whose rays end at opaque surfaces. Rays
/// round the transmittance of translucent surfaces in another way.
bool FrameRenderer::paints_surfaces() const {
  const RenderOptions& options = scene_.options;
  const bool finds_edges =
      options.antialiasing && options.quality != Quality::kDraft;  // of the whole picture
  if (finds_edges && options.size.pixels() > scene_.max_memory_bytes / 4 / kBytesToFindEdges) return false;
  const bool alone = voxels() == 0 && (slice_axis() || all_opaque());
  return (alone || ends_at_surfaces()) && !options.ids && !needs_depths();
}

bool FrameRenderer::ends_at_surfaces() const {
  return may_be_rough(scene_.options) && voxels() > 0 &&
         (!scene_.surfaces.empty() || scene_.faces != nullptr) && all_opaque();
}

bool FrameRenderer::all_opaque() const {
  return std::ranges::all_of(scene_.surfaces, [](const SurfaceDraw& surface) { return surface.is_opaque(); });
}

bool FrameRenderer::needs_depths() const {
  return scene_.options.depths || cues_depth(scene_.options);
}

/// Finishes the depth map, and darkens the picture by it (Luft et al. 2006), if the options ask for them.
void FrameRenderer::finish_depths(Picture& picture) {
  Stopwatch watch;
  if (needs_depths()) {
    const ViewDepth view_depth(scene_.view, scene_.grid);
    add_face_depths(buffers_.faces, shown(), view_depth, buffers_.depths, pool_);
    for (std::size_t n = 0; n < buffers_.depths.mm.size(); ++n) {
      if (picture.rgba[4 * n + 3] < kMinIdOpacity) buffers_.depths.mm[n] = DepthMap::kBackground;
    }
  }
  if (cues_depth(scene_.options)) {
    darken_edges(buffers_.depths, depth_edges(scene_.view.plane, scene_.options.depth_cue_strength), picture,
                 pool_);
  }
  stats_.depth_cue = watch.lap();
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

Result<void> rasterize_again(const ShownFrame& frame, std::uint64_t number,
                             std::span<const SurfaceDraw> surfaces, const Grid& grid, std::int32_t column,
                             std::int32_t row, FrameBuffers& buffers, ThreadPool& pool) {
  const ParallelView& plane = frame.view.plane;
  const Lighting lighting(plane);
  SPLATLAS_ASSIGN_OR_RETURN(
      RasterScene scene,
      frame.sheets ? raster_scene(surfaces, plane, factorise(plane, grid, &*frame.sheets), grid, lighting)
                   : raster_scene_of_rays(surfaces, frame.view, grid, lighting));
  const std::int32_t first = row / PickedRows::kRows * PickedRows::kRows;
  scene.region = intersection(scene.region, {0, scene.size.width, first, first + PickedRows::kRows - 1});
  buffers.picked = {};
  SurfaceCuts cuts;
  add_cuts(frame, grid, buffers.faces, cuts, scene, pool);
  if (draw_fragments(scene, frame.raster, cuts, buffers, pool)) {
    buffers.picked = {number, first};
    return {};
  }
  scene.region = {column, column, row, row};
  SPLATLAS_RETURN_IF_ERROR(draw_fragments(scene, frame.raster, cuts, buffers, pool));
  return {};
}

void fit_ids(const Picture& picture, IdImage& ids) {
  const int width = picture.size.width, height = picture.size.height;
  const auto opacity_of = [&](std::size_t pixel) { return picture.rgba[4 * pixel + 3]; };
  std::vector<std::size_t> open;  // visible pixels without a number
  for (std::size_t n = 0; n < ids.numbers.size(); ++n) {
    if (opacity_of(n) < kMinIdOpacity) {
      ids.numbers[n] = 0;
    } else if (ids.numbers[n] == 0) {
      open.push_back(n);
    }
  }
  // Advance by a pixel at a time
  const auto neighbour_of = [&](std::size_t pixel) {
    const int column = static_cast<int>(pixel) % width, row = static_cast<int>(pixel) / width;
    StructureNumber number = 0;
    float densest = 0;
    for (int y = std::max(row - 1, 0); y <= std::min(row + 1, height - 1); ++y) {
      for (int x = std::max(column - 1, 0); x <= std::min(column + 1, width - 1); ++x) {
        const std::size_t other = picture.size.pixel(x, y);
        if (ids.numbers[other] == 0 || opacity_of(other) <= densest) continue;
        densest = opacity_of(other);
        number = ids.numbers[other];
      }
    }
    return number;
  };
  std::vector<StructureNumber> found;
  while (!open.empty()) {
    found.clear();
    for (const std::size_t pixel : open) found.push_back(neighbour_of(pixel));
    for (std::size_t n = 0; n < open.size(); ++n) ids.numbers[open[n]] = found[n];
    if (std::erase_if(open, [&](std::size_t pixel) { return ids.numbers[pixel] != 0; }) == 0) return;
  }
}

void add_surface_depths(const FragmentList& fragments, const ShownFrame& frame, const ViewDepth& view,
                        DepthMap& depths, ThreadPool& pool) {
  const int width = depths.size.width;
  const auto include = depth_merger(frame, view, depths);
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
}

}  // namespace splatlas
