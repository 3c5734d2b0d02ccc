// Image of a finished sheet, and its warp into the picture, composited with surface fragments.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "format/tasks/thread_pool.h"
#include "player/picture.h"
#include "player/render/clip/face_layer.h"
#include "player/render/sheets/warp/warp_kernels.h"
#include "player/render/surfaces/fragments.h"
#include "player/render/view/pixel_box.h"
#include "player/render/view/shear.h"

namespace splatlas {

/// Weighted sum of the pixels at `upper`, to its right, and of the two pixels `row_floats` below. `color` is
/// the factor of white for 2 channels.
[[nodiscard]] inline Radiance sheet_sample(const float* upper, std::int64_t row_floats, std::int64_t channels,
                                           const std::array<float, 4>& weights,
                                           const std::array<float, 3>& color) {
  const float* lower = upper + row_floats;
  Radiance radiance;
  for (std::int64_t c = 0; c < channels; ++c) {
    radiance.rgba[static_cast<std::size_t>(c)] = weights[0] * upper[c] + weights[1] * upper[channels + c] +
                                                 weights[2] * lower[c] + weights[3] * lower[channels + c];
  }
  return channels == 4 ? radiance : in_color(radiance.rgba[0], radiance.rgba[1], color);
}

/// The finished sheet, with a transparent border of one pixel.
struct SheetImage {
  SheetWindow window;
  int channels = 4;                     ///< 4: red, green, blue, opacity; 2: white, opacity
  std::array<float, 3> color{1, 1, 1};  ///< factor of white
  std::vector<float> pixels;            ///< (fine_rows + 2) * (fine_columns + 2) * channels

  /// Row stride in pixels.
  [[nodiscard]] std::int64_t stride() const { return window.fine_columns() + 2; }
  /// Pixel (x, y), with -1 <= x <= fine_columns and -1 <= y <= fine_rows.
  [[nodiscard]] const float* at(std::int64_t x, std::int64_t y) const {
    return &pixels[static_cast<std::size_t>(((y + 1) * stride() + x + 1) * channels)];
  }
};

/// Surface fragments, and what is composited of them.
struct FragmentsInVolume {
  const FragmentList& list;
  std::span<const SheetSample> samples;  ///< as of the list
  const FaceLayer* faces = nullptr;      ///< of the cut, at pixel centres; null: none
};

/// Warps the sheet (Lacroute and Levoy 1994), and puts the rest of it behind the fragments. Interpolation in
/// the sheet is bilinear, or cubic for pixels without fragments if the window asks for it. Minified pixels
/// are the mean of several samples. Faces of a cut are composited in front of and behind everything else.
/// `painted`: the picture holds what is behind the volume, without fragments. Writes the pixels of a region.
/// Cost: linear in its pixels and fragments.
void resolve(const SheetImage& sheet, const Shear& shear, const FragmentsInVolume& fragments,
             const PixelBox& region, const WarpKernels& kernels, bool painted, Picture& picture,
             ThreadPool& pool);

}  // namespace splatlas
