// Ray casting of a frame: perspective projection or post-classification; ray volume of a selection.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "player/render/frame/decoded_selection.h"
#include "player/render/frame/draft_pace.h"
#include "player/render/frame/drawn_selection.h"
#include "player/render/frame/frame_renderer.h"
#include "player/render/rays/volume/ray_volume.h"
#include "player/render_options.h"

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

/// Cache of the ray volume of the current selection: its voxels, and means or blocks of voxels that stand in
/// for them in drafts. Not thread-safe.
class RayStore {
 public:
  /// True if the volume can draw with these options: require() will build no voxels.
  [[nodiscard]] bool fits(const RenderOptions& options) const {
    return volume_ && !by_blocks_ && volume_->fits(options.classification, options.hybrid_shading);
  }
  /// Prepares the volume of a frame: builds its voxels, numbered for ids, unless that is done; for a draft in
  /// a budget chooses its detail and averages the voxels. `walked`: as of RayVolumeRequest. Errors and cost
  /// as for RayVolume::build().
  [[nodiscard]] Result<void> require(const View& view, const RenderOptions& options, const Atlas& atlas,
                                     const DrawnSelection& drawn, const ClassCache& cache,
                                     std::uint64_t max_memory_bytes, ThreadPool& pool, bool walked = false);
  /// Reads blocks of voxels instead, pre-classified. False on any error, which reading the voxels will tell.
  [[nodiscard]] bool require_blocks(const RenderOptions& options, const std::shared_ptr<const Atlas>& atlas,
                                    const DrawnSelection& drawn, std::uint64_t max_memory_bytes,
                                    ThreadPool& pool);
  /// True if require_walk() will build no voxels.
  [[nodiscard]] bool fits_walk() const { return volume_ && !by_blocks_ && volume_->fits_walk(); }
  /// Prepares an unlit volume for the ids and depths of a picture by sheets. As require(); if the voxels take
  /// too much memory, blocks stand in for them for a depth cue alone.
  [[nodiscard]] Result<void> require_walk(const View& view, const RenderOptions& options,
                                          const std::shared_ptr<const Atlas>& atlas,
                                          const DrawnSelection& drawn, const ClassCache& cache,
                                          std::uint64_t max_memory_bytes, ThreadPool& pool);
  /// Records the times of the latest frame.
  void took(const RenderStats& stats, const RenderOptions& options) {
    if (!by_blocks_ && options.classification == Classification::kBefore) pace_.took(stats, options);
  }
  /// Drops the volume. Does not throw.
  void clear();

  /// The volume of the latest frame; require() or require_blocks() must have succeeded.
  [[nodiscard]] RayVolume& volume() { return level_ > 0 && !by_blocks_ ? *means_ : *volume_; }
  /// Upper bound of its memory; 0 without a volume.
  [[nodiscard]] std::uint64_t bytes() const { return volume_ ? volume_->bytes() : 0; }
  /// The volume within the grid of the atlas.
  [[nodiscard]] RayScene scene(const Grid& grid) { return {volume(), coarse_grid(grid, level_), level_}; }
  /// Its level: 0 for voxels, or blocks of 2^level voxels along each axis.
  [[nodiscard]] int level() const { return level_; }

 private:
  [[nodiscard]] Result<void> require_voxels(const RenderOptions& options, const Atlas& atlas,
                                            const DrawnSelection& drawn, const SelectedRuns& runs,
                                            const ClassCache& cache, std::uint64_t max_memory_bytes,
                                            ThreadPool& pool, bool walked);

  std::optional<RayVolume> volume_;  // of voxels or blocks
  bool by_blocks_ = false;
  std::optional<RayVolume> means_;  // of the voxels
  int means_level_ = 0;
  int level_ = 0;
  DraftPace pace_{true};
};

}  // namespace splatlas
