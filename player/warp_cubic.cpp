#include "player/warp_cubic.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace splatlas {
namespace {

constexpr int kTaps = 4;

/// Of the two pixels before a place and the two behind it; `part` of the way between the middle ones.
std::array<float, kTaps> cubic_weights(float part) {
  const float rest = 1 - part;
  return {-0.5f * part * rest * rest, 1 + part * part * (1.5f * part - 2.5f),
          1 + rest * rest * (1.5f * rest - 2.5f), -0.5f * rest * part * part};
}

/// Weighted sums of 4 x 4 pixels.
template <int kChannels>
class Cubic {
 public:
  explicit Cubic(const SheetImage& sheet) : sheet_(sheet) {}

  [[nodiscard]] Light at(double x, double y) const {
    const double column = std::floor(x), row = std::floor(y);
    const auto left = static_cast<std::int64_t>(column) - 1, upper = static_cast<std::int64_t>(row) - 1;
    const std::array<float, kTaps> across = cubic_weights(static_cast<float>(x - column));
    const std::array<float, kTaps> down = cubic_weights(static_cast<float>(y - row));
    const bool inside = left >= -1 && left + kTaps - 1 <= sheet_.window.fine_columns();
    std::array<float, kRow> sums{};
    for (std::int64_t n = 0; n < kTaps; ++n) {
      if (upper + n < 0 || upper + n >= sheet_.window.fine_rows()) continue;
      const float weight = down[static_cast<std::size_t>(n)];
      if (inside) {
        add(weight, sheet_.at(left, upper + n), sums);
      } else {
        add(weight, near_border(left, upper + n).data(), sums);
      }
    }
    return in_bounds(across, sums);
  }

 private:
  static constexpr std::size_t kRow = std::size_t{kTaps} * kChannels;

  static void add(float weight, const float* pixels, std::array<float, kRow>& sums) {
    for (std::size_t n = 0; n < kRow; ++n) sums[n] += weight * pixels[n];
  }

  /// Four pixels, nothing where they are outside the sheet.
  [[nodiscard]] std::array<float, kRow> near_border(std::int64_t left, std::int64_t row) const {
    std::array<float, kRow> pixels{};
    for (std::int64_t n = 0; n < kTaps; ++n) {
      if (left + n < 0 || left + n >= sheet_.window.fine_columns()) continue;
      std::copy_n(sheet_.at(left + n, row), kChannels, pixels.begin() + n * kChannels);
    }
    return pixels;
  }

  [[nodiscard]] Light in_bounds(const std::array<float, kTaps>& across,
                                const std::array<float, kRow>& sums) const {
    std::array<float, kChannels> channels{};
    for (std::size_t n = 0; n < kTaps; ++n) {
      for (std::size_t c = 0; c < kChannels; ++c) channels[c] += across[n] * sums[n * kChannels + c];
    }
    Light light{{channels[0], channels[1], channels[kChannels - 2], channels.back()}};
    if constexpr (kChannels == 2) light = in_color(channels[0], channels[1], sheet_.color);
    const float alpha = std::clamp(light.rgba[3], 0.0f, 1.0f);
    for (float& channel : light.rgba) channel = std::clamp(channel, 0.0f, alpha);
    return light;
  }

  const SheetImage& sheet_;
};

template <int kChannels>
void warp(const SheetImage& sheet, const Affine2& map, double y, int from, int to, float* out) {
  const Cubic<kChannels> cubic(sheet);
  for (int column = from; column < to; ++column) {
    const double x = column + 0.5;
    const Light light = cubic.at(map.xx * x + map.xy * y + map.x0, map.yx * x + map.yy * y + map.y0);
    std::copy(light.rgba.begin(), light.rgba.end(), out + std::ptrdiff_t{4} * column);
  }
}

}  // namespace

Light sample_cubic(const SheetImage& sheet, double x, double y) {
  return sheet.channels == 2 ? Cubic<2>(sheet).at(x, y) : Cubic<4>(sheet).at(x, y);
}

void warp_cubic(const SheetImage& sheet, const Affine2& map, double y, int from, int to, float* out) {
  sheet.channels == 2 ? warp<2>(sheet, map, y, from, to, out) : warp<4>(sheet, map, y, from, to, out);
}

}  // namespace splatlas
