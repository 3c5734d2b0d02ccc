// Map from the picture to the pixels of the sheet.
#pragma once

#include <algorithm>
#include <cmath>

#include "player/sheets/sheet_window.h"
#include "player/view/shear.h"

namespace splatlas {

/// Picture coordinates to sheet pixels.
[[nodiscard]] inline Affine2 picture_to_pixels(const Shear& shear, const SheetWindow& window) {
  const Affine2& map = shear.picture_to_sheet;
  const double scale = window.scale;
  return {map.xx * scale, map.xy * scale, (map.x0 - static_cast<double>(window.u0)) * scale,
          map.yx * scale, map.yy * scale, (map.y0 - static_cast<double>(window.v0)) * scale};
}

/// Maximum distance in the sheet, in its pixels, of adjacent picture pixels.
[[nodiscard]] inline double longest_step(const Affine2& map) {
  return std::max(std::hypot(map.xx, map.yx), std::hypot(map.xy, map.yy));
}

/// Samples of a picture pixel along each axis, by its width in voxels: finer sheets add no detail.
[[nodiscard]] inline int samples_per_side(const Affine2& map, const SheetWindow& window) {
  constexpr double kMaxSamplesPerSide = 16;
  const double voxels = longest_step(map) / window.scale;
  return static_cast<int>(std::clamp(std::ceil(voxels - 0.25), 1.0, kMaxSamplesPerSide));
}

}  // namespace splatlas
