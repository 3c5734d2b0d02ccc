// Ray casting of a frame: perspective projection or post-classification.
#pragma once

#include <optional>

#include "player/render/frame/frame_renderer.h"

namespace splatlas {

/// The volume must be lit, and outlive the frame.
class RayFrame : public FrameRenderer {
 public:
  RayFrame(const FrameScene& scene, const RayScene& of_volume, FrameBuffers& buffers, RenderStats& stats,
           ThreadPool& pool);

 private:
  [[nodiscard]] Result<RasterScene> raster_scene_of_view() const override;
  [[nodiscard]] Result<void> begin_volume(Picture& picture) override;
  [[nodiscard]] Result<void> resolve(const PixelBox& region, Picture& picture) override;
  [[nodiscard]] int level() const override { return of_volume_.level; }
  [[nodiscard]] std::uint64_t voxels() const override { return of_volume_.volume.voxels(); }
  [[nodiscard]] std::optional<Axis> slice_axis() const override { return std::nullopt; }

  RayScene of_volume_;
  CastOptions options_;
};

/// Rays per pixel, and steps per slab and error tolerance of ray marching at the quality of the options.
[[nodiscard]] CastOptions cast_options(const FrameScene& scene, const Grid& grid);

/// Width of a voxel in picture pixels, for the choice of levels: in the plane of the centre, but at least
/// half of that at the corner of the grid nearest to the eye; infinite if the grid reaches behind the eye.
[[nodiscard]] double voxel_pixels_of(const View& view, const Grid& grid);

/// True for pictures that sheets cannot draw.
[[nodiscard]] bool needs_rays(const View& view, const RenderOptions& options);
/// True for pictures by ray casting, false for shear-warp factorisation. Rays also draw volumes that are
/// better by them; they alias at planes along the view.
[[nodiscard]] bool draws_by_rays(const DrawPlan& plan, const View& view, const RenderOptions& options);

}  // namespace splatlas
