// Detail of drafts within a budget of time.
#pragma once

#include <algorithm>

namespace splatlas {

/// Detail of the volume of a picture by sheets.
struct VolumeDetail {
  int level = 0;      ///< means of 2^level voxels along each axis
  int max_scale = 2;  ///< maximum of sheet pixels per voxel of the level, in drafts

  friend bool operator==(const VolumeDetail&, const VolumeDetail&) = default;
};

/// Chooses the detail of each draft by the time of the latest one: first one sheet pixel per voxel, then
/// downsampled volumes.
class DraftPace {
 public:
  /// Maximum width of a downsampled voxel, in picture pixels.
  static constexpr double kMaxPixels = 6;

  /// Detail of the next draft. `voxel_pixels`: Shear::voxel_pixels(). `has_voxels`: the spans of the voxels
  /// exist; else downsampled ones take their place, unless their voxels are too wide.
  [[nodiscard]] VolumeDetail next(double voxel_pixels, bool has_voxels) {
    max_ = 1;
    for (double width = 2 * voxel_pixels; width <= kMaxPixels && max_ < kMaxStep; width *= 2) ++max_;
    // Below this width, sheets have one pixel per voxel anyway
    step_ = std::clamp(step_, voxel_pixels > 1.25 ? 0 : 1, max_);
    const int step = has_voxels || max_ < 2 ? step_ : std::max(step_, 2);
    return {std::max(step - 1, 0), step == 0 ? 2 : 1};
  }

  /// Records the time of a draft of `next()`.
  void took(double ms, double budget_ms) {
    for (; ms > budget_ms && step_ < max_; ++step_) ms /= gain(step_);
    if (step_ > 0 && ms * gain(step_ - 1) < budget_ms) --step_;
  }

 private:
  static constexpr int kMaxStep = 6;
  /// Time of a step over that of the next one, at most: 4 times the sheet pixels, or 8 times the voxels out
  /// of the caches. Less would draw steps in turns, and build their means anew each time.
  static double gain(int step) { return step == 0 ? 4 : 12; }

  int step_ = 0, max_ = 1;
};

}  // namespace splatlas
