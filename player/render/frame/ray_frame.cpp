#include "player/render/frame/ray_frame.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "format/result_macros.h"
#include "player/render/frame/stopwatch.h"

namespace splatlas {
namespace {

/// The rays of a pixel: at least `per_voxel` per voxel on each axis along which pixels exceed voxels.
RayGrid rays_of_pixel(const FrameScene& scene, const Grid& grid, double per_voxel) {
  if (scene.overrides.one_ray) return {};
  const auto [along_width, along_height] = factorise(scene.view.plane, grid).voxels_per_pixel();
  const auto rays = [per_voxel](double voxels) {
    constexpr double kMost = 32;
    return voxels > 1 ? static_cast<int>(std::ceil(std::min(per_voxel * voxels, kMost))) : 1;
  };
  return {rays(along_width), rays(along_height)};
}

}  // namespace

CastOptions cast_options(const FrameScene& scene, const Grid& grid) {
  CastOptions cast{.termination_threshold = termination_threshold(scene.options),
                   .principal_axis = scene.overrides.principal_axis};
  switch (scene.options.quality) {
    case Quality::kDraft: break;
    case Quality::kNormal:
      cast.rays = rays_of_pixel(scene, grid, 1);
      cast.max_steps = 32;
      cast.tolerance = 0.054f;
      break;
    case Quality::kHigh:
      cast.rays = rays_of_pixel(scene, grid, 1.5);
      cast.min_steps = 8;
      cast.max_steps = 64;
      cast.tolerance = 0.0046f;
      break;
  }
  return cast;
}

RayFrame::RayFrame(const FrameScene& scene, const RayScene& of_volume, FrameBuffers& buffers,
                   RenderStats& stats, ThreadPool& pool)
    : FrameRenderer(scene, of_volume.grid, buffers, stats, pool),
      of_volume_(of_volume),
      options_(cast_options(scene, of_volume.grid)) {}

Result<RasterScene> RayFrame::raster_scene_of_view() const {
  return raster_scene_of_rays(scene_.surfaces, scene_.view, scene_.grid, scene_.lighting);
}

Result<void> RayFrame::begin_volume(Picture& picture) {
  Stopwatch watch;
  options_.cuts = cuts();
  options_.faces = faces();
  if (scene_.options.ids) options_.ids = &buffers_.ids;
  if (needs_depths()) options_.depths = &buffers_.depths;
  const RayEnds ends{buffers_.surface_depths, *raster_};
  CastOptions options = options_;
  if (ends_at_surfaces()) options.ends = &ends;
  cast_rays(of_volume_.volume, scene_.view, of_volume_.grid, options, kernels(), &picture, pool_);
  stats_.voxels_visited = of_volume_.volume.voxels();
  stats_.sheets = watch.lap();
  return {};
}

Result<void> RayFrame::resolve(const PixelBox& /*region*/, Picture& picture) {
  Stopwatch watch;
  cast_surfaces(of_volume_.volume, scene_.view, of_volume_.grid, *raster_, buffers_.fragments, options_,
                kernels(), &picture, pool_);
  stats_.resolve += watch.lap();
  return {};
}

double voxel_pixels_of(const View& view, const Grid& grid) {
  const double in_plane = factorise(view.plane, grid).voxel_pixels();
  if (!view.eye_mm) return in_plane;
  const Projection projection(view.plane, grid, *view.eye_mm);
  double nearest = 1;  // to the eye, in distances of the plane
  for (std::size_t corner = 0; corner < 8; ++corner) {
    std::array<float, 3> index{};
    for (std::size_t a = 0; a < 3; ++a)
      index[a] = static_cast<float>((corner >> a & 1) != 0 ? grid.size[a] - 1 : 0);
    nearest = std::min(nearest, projection.homogeneous(index).w);
  }
  if (nearest <= 0) return std::numeric_limits<double>::infinity();
  return in_plane * std::max(1.0, 0.5 / nearest);
}

bool needs_rays(const View& view, const RenderOptions& options) {
  return view.eye_mm || options.classification == Classification::kAfter;
}

bool draws_by_rays(const DrawPlan& plan, const View& view, const RenderOptions& options) {
  if (needs_rays(view, options)) return true;
  constexpr double kEdgeOn = 0.01;
  const auto is_along_view = [&](const CutPlane& cut) {
    const auto& [x, y, z] = cut.normal_lps;
    return std::abs(dot(cut.normal_lps, view.plane.forward_lps)) < kEdgeOn * std::hypot(x, y, z);
  };
  return options.quality == Quality::kHigh && !volume_classes(plan).empty() &&
         std::none_of(options.cuts.begin(), options.cuts.end(), is_along_view);
}

Result<void> RayStore::require(const View& view, const RenderOptions& options, const Atlas& atlas,
                               const DrawnSelection& drawn, const ClassCache& cache,
                               std::uint64_t max_memory_bytes, ThreadPool& pool, bool walked) {
  const SelectedRuns runs(drawn.plan(), atlas.classes(), cache, Axis::kZ);
  SPLATLAS_RETURN_IF_ERROR(
      require_voxels(options, atlas, drawn, runs, cache, max_memory_bytes, pool, walked));
  level_ = may_be_rough(options) && options.classification == Classification::kBefore
               ? pace_.next(voxel_pixels_of(view, atlas.grid()), true).level
               : 0;
  if (level_ == 0 || (means_ && means_level_ == level_)) return {};
  means_.reset();
  if (auto means = volume_->means(runs, level_, pool)) {
    means_ = *std::move(means);
    means_level_ = level_;
  } else {
    level_ = 0;
  }
  return {};
}

Result<void> RayStore::require_voxels(const RenderOptions& options, const Atlas& atlas,
                                      const DrawnSelection& drawn, const SelectedRuns& runs,
                                      const ClassCache& cache, std::uint64_t max_memory_bytes,
                                      ThreadPool& pool, bool walked) {
  if (walked ? !fits_walk() : !fits(options)) {
    if (!by_blocks_) clear();  // blocks are small, and serve again if the voxels do not fit
    SPLATLAS_ASSIGN_OR_RETURN(RayVolume built,
                              RayVolume::build({.atlas = atlas,
                                                .selection = drawn.selection(),
                                                .plan = drawn.plan(),
                                                .appearances = drawn.appearances().appearances(),
                                                .runs = runs,
                                                .cache = cache,
                                                .classification = options.classification,
                                                .shade = options.hybrid_shading,
                                                .walked = walked,
                                                .max_memory_bytes = max_memory_bytes},
                                               pool));
    clear();
    volume_ = std::move(built);
  }
  if (!options.ids || volume_->numbers() != nullptr) return {};
  return volume_->number(runs, drawn.numbers(), pool);
}

Result<void> RayStore::require_walk(const View& view, const RenderOptions& options,
                                    const std::shared_ptr<const Atlas>& atlas, const DrawnSelection& drawn,
                                    const ClassCache& cache, std::uint64_t max_memory_bytes,
                                    ThreadPool& pool) {
  RenderOptions unlit = options;
  unlit.hybrid_shading = false;
  Result<void> built = require(view, unlit, *atlas, drawn, cache, max_memory_bytes, pool, true);
  if (built || built.error().code != ErrorCode::kLimit) return built;
  if (!options.ids && !options.depths && require_blocks(unlit, atlas, drawn, max_memory_bytes, pool))
    return {};
  built.error().message += ", or render without ids, depth map, outlines and depth cue";
  return built;
}

bool RayStore::require_blocks(const RenderOptions& options, const std::shared_ptr<const Atlas>& atlas,
                              const DrawnSelection& drawn, std::uint64_t max_memory_bytes, ThreadPool& pool) {
  if (by_blocks_ && volume_->fits(Classification::kBefore, options.hybrid_shading)) return true;
  clear();
  const auto read = BlockVolume::read(atlas, drawn.plan(), pool);
  if (!read) return false;
  BlockVolume& blocks = **read;
  blocks.require(Axis::kZ, pool);
  VolumeAppearances appearances(*atlas);
  appearances.select(blocks.plan(), drawn.selection());
  if (options.hybrid_shading)
    light_voxels(blocks.plan(), appearances, blocks.classes(), blocks.grid(), blocks.cache(), pool);
  const SelectedRuns runs(blocks.plan(), blocks.classes(), blocks.cache(), Axis::kZ);
  auto built = RayVolume::build({.atlas = *atlas,
                                 .selection = drawn.selection(),
                                 .plan = blocks.plan(),
                                 .appearances = appearances.appearances(),
                                 .runs = runs,
                                 .cache = blocks.cache(),
                                 .shade = options.hybrid_shading,
                                 .max_memory_bytes = max_memory_bytes,
                                 .blocks = &blocks},
                                pool);
  if (!built) return false;
  volume_ = std::move(*built);
  by_blocks_ = true;
  level_ = kMeanLevel;
  return true;
}

void RayStore::clear() {
  volume_.reset();
  means_.reset();
  by_blocks_ = false;
  level_ = 0;
}

}  // namespace splatlas
