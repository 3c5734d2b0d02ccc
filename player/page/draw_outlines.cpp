#include "player/page/draw_outlines.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace splatlas {
namespace {

constexpr double kMaxStep = 12;       // of depths, in pixels
constexpr int kPixelsPerWidth = 900;  // of the short side
constexpr float kOpaque = 0.95f;
constexpr float kDarkness = 0.75f;  // of a line

using Coverage = std::vector<float>;

/// 1 for pixels that differ from their right or lower neighbour, else 0.
Coverage edges_of(const Picture& picture, const IdImage& ids, const DepthMap& depths, double mm_per_pixel) {
  const auto width = static_cast<std::size_t>(ids.size.width),
             height = static_cast<std::size_t>(ids.size.height);
  const auto max_step = static_cast<float>(kMaxStep * mm_per_pixel);
  const auto differ = [&](std::size_t a, std::size_t b) {
    // Layers of translucent structures would cross their lines
    if (std::max(picture.rgba[4 * a + 3], picture.rgba[4 * b + 3]) < kOpaque) return false;
    const float step = std::abs(depths.mm[a] - depths.mm[b]);  // NaN between backgrounds
    return ids.numbers[a] != ids.numbers[b] || step > max_step;
  };
  Coverage edges(width * height);
  for (std::size_t y = 0; y < height; ++y) {
    for (std::size_t x = 0; x < width; ++x) {
      const std::size_t n = y * width + x;
      if ((x + 1 < width && differ(n, n + 1)) || (y + 1 < height && differ(n, n + width))) edges[n] = 1;
    }
  }
  return edges;
}

/// Replaces each value of a row or column by combine(values within `reach` before and behind it).
template <typename Combine>
Coverage filtered(const Coverage& from, std::size_t width, std::size_t step, int before, int behind,
                  const Combine& combine) {
  Coverage to(from.size());
  const std::size_t count = step == 1 ? width : from.size() / width;
  const std::size_t lines = from.size() / count;
  for (std::size_t line = 0; line < lines; ++line) {
    const std::size_t first = step == 1 ? line * width : line;
    for (std::size_t n = 0; n < count; ++n) {
      const auto at = static_cast<std::ptrdiff_t>(n), end = static_cast<std::ptrdiff_t>(count);
      float sum = 0;
      for (std::ptrdiff_t i = at - before; i <= at + behind; ++i)
        sum = combine(sum, i < 0 || i >= end ? 0 : from[first + static_cast<std::size_t>(i) * step], i - at);
      to[first + n * step] = sum;
    }
  }
  return to;
}

}  // namespace

void draw_outlines(const IdImage& ids, const DepthMap& depths, double mm_per_pixel, Picture& picture) {
  const auto width = static_cast<std::size_t>(picture.size.width);
  Coverage lines = edges_of(picture, ids, depths, mm_per_pixel);

  // Widen them, and soften their edges
  const int wide = std::max(1, std::min(picture.size.width, picture.size.height) / kPixelsPerWidth);
  const auto largest = [](float a, float b, std::ptrdiff_t) { return std::max(a, b); };
  const auto tent = [](float sum, float value, std::ptrdiff_t away) {
    return sum + (away == 0 ? 0.5f : 0.25f) * value;
  };
  for (const std::size_t step : {std::size_t{1}, width}) {
    if (wide > 1) lines = filtered(lines, width, step, wide / 2, (wide - 1) / 2, largest);
    lines = filtered(lines, width, step, 1, 1, tent);
  }

  // A single line of pixels has a coverage of one half after the tent
  for (std::size_t n = 0; n < lines.size(); ++n) {
    const float dark = kDarkness * std::min(1.0f, 2 * lines[n]);
    float* const pixel = &picture.rgba[4 * n];
    for (std::size_t c = 0; c < 3; ++c) pixel[c] *= 1 - dark;
    pixel[3] += (1 - pixel[3]) * dark;
  }
}

}  // namespace splatlas
