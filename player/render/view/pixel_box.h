// Rectangles of pixels.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "player/camera.h"

namespace splatlas {

/// Rectangle of pixels, with both ends included.
struct PixelBox {
  std::int32_t x_first = 0, x_last = -1, y_first = 0, y_last = -1;

  /// All pixels of a picture.
  [[nodiscard]] static PixelBox of(const PictureSize& size) {
    return {0, size.width - 1, 0, size.height - 1};
  }

  [[nodiscard]] bool empty() const { return x_first > x_last || y_first > y_last; }
  [[nodiscard]] std::int32_t width() const { return x_last - x_first + 1; }
  [[nodiscard]] std::int32_t height() const { return y_last - y_first + 1; }
  [[nodiscard]] std::size_t pixels() const {
    return empty() ? 0 : static_cast<std::size_t>(width()) * static_cast<std::size_t>(height());
  }
  /// Place of a pixel among those of the rectangle, row by row.
  [[nodiscard]] std::size_t place(std::int32_t x, std::int32_t y) const {
    return static_cast<std::size_t>(y - y_first) * static_cast<std::size_t>(width()) +
           static_cast<std::size_t>(x - x_first);
  }
  [[nodiscard]] bool contains(std::int32_t x, std::int32_t y) const {
    return x >= x_first && x <= x_last && y >= y_first && y <= y_last;
  }
  /// With `by` more pixels on each side.
  [[nodiscard]] PixelBox grown(std::int32_t by) const {
    return {x_first - by, x_last + by, y_first - by, y_last + by};
  }
};

[[nodiscard]] inline PixelBox intersection(const PixelBox& a, const PixelBox& b) {
  return {std::max(a.x_first, b.x_first), std::min(a.x_last, b.x_last), std::max(a.y_first, b.y_first),
          std::min(a.y_last, b.y_last)};
}

}  // namespace splatlas
