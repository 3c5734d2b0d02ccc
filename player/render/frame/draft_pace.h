// Detail of drafts within a budget of time.
#pragma once

#include <algorithm>
#include <cmath>

#include "format/derive/coarse_surface.h"
#include "player/render_options.h"

namespace splatlas {

/// True for drafts with a budget that need no exact depths.
[[nodiscard]] inline bool may_be_rough(const RenderOptions& options) {
  return options.quality == Quality::kDraft && options.draft_budget_ms > 0 && !options.ids &&
         !options.depths && options.depth_cue == DepthCue::kNone;
}

/// Detail of the volume of a picture by sheets.
struct VolumeDetail {
  int level = 0;      ///< means of 2^level voxels along each axis
  int max_scale = 2;  ///< maximum of sheet pixels per voxel of the level, in drafts

  friend bool operator==(const VolumeDetail&, const VolumeDetail&) = default;
};

/// Chooses a draft's detail by the time of the latest: first a sheet pixel a voxel, then downsampled volumes.
class DraftPace {
 public:
  /// `by_rays`: pictures by rays, which have no sheet pixels.
  explicit DraftPace(bool by_rays = false) : min_(by_rays ? 1 : 0) {}

  /// Maximum width of a downsampled voxel, in picture pixels.
  static constexpr double kMaxPixels = 6;

  /// Detail of the next draft. `voxel_pixels`: Shear::voxel_pixels(). `has_voxels`: the spans of the voxels
  /// exist; else downsampled ones take their place, unless their voxels are too wide.
  [[nodiscard]] VolumeDetail next(double voxel_pixels, bool has_voxels) {
    max_ = 1;
    for (double width = 2 * voxel_pixels; width <= kMaxPixels && max_ < kMaxStep; width *= 2) ++max_;
    // Below this width, sheets have one pixel per voxel anyway
    step_ = std::clamp(step_, voxel_pixels > 1.25 ? min_ : 1, max_);
    const int step = has_voxels || max_ < 2 ? step_ : std::max(step_, 2);
    return {std::max(step - 1, 0), step == 0 ? 2 : 1};
  }

  /// Records the time of a draft of `next()`.
  void took(double ms, double budget_ms) {
    for (; ms > budget_ms && step_ < max_; ++step_) ms /= gain(step_);
    if (step_ > min_ && ms * gain(step_ - 1) < budget_ms) --step_;
  }
  /// The same for a finished draft with a volume. Surfaces take as long with any detail of it.
  void took(const RenderStats& stats, const RenderOptions& options) {
    if (!may_be_rough(options) || stats.voxels_visited == 0) return;
    const double budget = options.draft_budget_ms, of_surfaces = stats.rasterize.wall_ms;
    took(stats.render_ms - of_surfaces, std::max(budget - of_surfaces, budget / 2));
  }

 private:
  static constexpr int kMaxStep = 6;
  /// Time of a step over that of the next one, at most: 4 times the sheet pixels, or 8 times the voxels out
  /// of the caches. Less would draw steps in turns, and build their means anew each time.
  static double gain(int step) { return step == 0 ? 4 : 12; }

  int min_ = 0, step_ = 0, max_ = 1;
};

/// Chooses the level of the surfaces of each draft: one whose silhouettes are nearly exact, or a
/// coarser one by the time of the latest draft.
class SurfacePace {
 public:
  /// Maximum widths of a block in picture pixels: for silhouettes within a pixel, after late drafts, and
  /// while finer surfaces do not exist.
  static constexpr double kFinePixels = 3, kMaxPixels = 6, kStandInPixels = 12;

  /// Level of the next draft. `voxel_pixels`: Shear::voxel_pixels(). `is_ready(level)`: its surfaces exist or
  /// soon will; else those of the next level take their place, unless their blocks are too wide.
  template <typename IsReady>
  [[nodiscard]] int next(double voxel_pixels, const IsReady& is_ready) {
    const auto level_within = [voxel_pixels](double pixels) {
      return std::clamp(std::ilogb(pixels / voxel_pixels), 0, Coverage::kMaxLevel);
    };
    min_ = level_within(kFinePixels);
    max_ = level_within(kMaxPixels);
    level_ = std::clamp(level_, min_, max_);
    int level = level_;
    while (level < level_within(kStandInPixels) && !is_ready(level)) ++level;
    return level;
  }

  /// Records the time to draw the surfaces of the latest draft.
  void took(double ms, double budget_ms) {
    constexpr double kGain = 4;  // the time of a level over that of the next one, at most
    for (; ms > budget_ms && level_ < max_; ++level_) ms /= kGain;
    if (level_ > min_ && ms * kGain < budget_ms) --level_;
  }

 private:
  int level_ = 0, min_ = 0, max_ = 0;
};

}  // namespace splatlas
