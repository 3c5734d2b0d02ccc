#include "player/render/sheets/hidden_pixels.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace splatlas {
namespace {

/// Picture pixels beside the one at a sheet pixel, up to the last that may sample it: the cubic warp reaches
/// two sheet pixels far, and samples lie half a pixel beside the centre.
int reach(double per_column, double per_row) {
  constexpr double kTaps = 2;
  return static_cast<int>(std::ceil(kTaps * (std::abs(per_column) + std::abs(per_row)) + 1));
}

}  // namespace

/// A summed-area table (Crow 1984).
HiddenPixels::HiddenPixels(const FaceLayer& faces)
    : columns_(faces.size.width),
      rows_(faces.size.height),
      open_(static_cast<std::size_t>((columns_ + 1) * (rows_ + 1))) {
  std::uint32_t* sum = open_.data() + columns_ + 2;
  std::size_t pixel = 0;
  for (std::int64_t row = 0; row < rows_; ++row, ++sum) {
    std::uint32_t of_row = 0;
    for (std::int64_t column = 0; column < columns_; ++column, ++sum, ++pixel) {
      of_row += faces.hides(pixel) ? 0 : 1;
      *sum = sum[-columns_ - 1] + of_row;
    }
  }
}

/// A point beside the picture has no pixels but those near the border.
bool HiddenPixels::is_hidden(double x, double y, int reach_x, int reach_y) const {
  const auto range = [](double at, int reach, std::int64_t count) {
    const auto pixel = static_cast<std::int64_t>(std::clamp(at, 0.0, static_cast<double>(count - 1)));
    return std::pair(std::max<std::int64_t>(pixel - reach, 0), std::min(pixel + reach + 1, count));
  };
  const auto [left, right] = range(x, reach_x, columns_);
  const auto [top, bottom] = range(y, reach_y, rows_);
  const auto sum = [&](std::int64_t column, std::int64_t row) {
    return open_[static_cast<std::size_t>(row * (columns_ + 1) + column)];
  };
  return sum(right, bottom) - sum(left, bottom) == sum(right, top) - sum(left, top);
}

void HiddenPixels::close(const Shear& shear, const SheetWindow& window, BandImage& image) const {
  const Affine2 map = inverse(picture_to_pixels(shear, window));
  const int reach_x = reach(map.xx, map.xy), reach_y = reach(map.yx, map.yy);
  const std::int64_t opacity = (image.planes() - 1) * image.plane_stride();
  for (std::int64_t row = image.first_fine_row(); row < image.last_fine_row(); ++row) {
    const auto v = static_cast<double>(row);
    for (std::int64_t column = 0; column < window.fine_columns(); ++column) {
      const auto u = static_cast<double>(column);
      if (!is_hidden(map.xx * u + map.xy * v + map.x0, map.yx * u + map.yy * v + map.y0, reach_x, reach_y))
        continue;
      image.rows(row, column % window.scale).pixels[opacity + column / window.scale] = 1;
    }
  }
}

}  // namespace splatlas
