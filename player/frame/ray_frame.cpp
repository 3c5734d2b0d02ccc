#include "player/frame/ray_frame.h"

#include "format/system/result_macros.h"
#include "player/frame/frame_settings.h"
#include "player/frame/stopwatch.h"
#include "player/rays/cast_surfaces.h"
#include "player/rays/ray_depths.h"

namespace splatlas {

RayFrame::RayFrame(const RayFrameRequest& request, FrameBuffers& buffers, ThreadPool& pool)
    : request_(request),
      buffers_(buffers),
      pool_(pool),
      kernels_(request.overrides.simd ? best_march() : scalar_march()),
      options_(cast_options(request.options, request.overrides)) {}

Result<void> RayFrame::rasterize() {
  Stopwatch watch;
  SPLATLAS_ASSIGN_OR_RETURN(const RasterScene scene, raster_scene_of_rays(request_.surfaces, request_.view,
                                                                          request_.grid, request_.lighting));
  scene_.emplace(scene);
  SPLATLAS_ASSIGN_OR_RETURN(
      const RasterCounters raster,
      buffers_.rasterizer.draw(*scene_, raster_options(request_.options, request_.max_memory_bytes),
                               buffers_.fragments, pool_));
  counters_.triangles = raster.triangles;
  counters_.rasterize = watch.lap();
  return {};
}

void RayFrame::cast_rays(Picture& picture) {
  Stopwatch watch;
  splatlas::cast_rays(request_.volume, request_.view, request_.grid, options_, kernels_, picture, pool_);
  counters_.voxels = request_.volume.voxels();
  counters_.sheets = watch.lap();
}

void RayFrame::resolve(Picture& picture) {
  Stopwatch watch;
  cast_surfaces(request_.volume, request_.view, request_.grid, *scene_, buffers_.fragments, options_,
                kernels_, picture, pool_);
  counters_.resolve = watch.lap();
}

void RayFrame::add_volume_depths(const ViewDepth& view_depth) {
  add_ray_depths(request_.volume, request_.view, request_.grid, kernels_, view_depth, buffers_.depths, pool_);
}

ShownFrame RayFrame::shown() const {
  return {request_.view, std::nullopt, scene_->depth_axis, scene_->depth_sign};
}

}  // namespace splatlas
