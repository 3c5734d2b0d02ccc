#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

#include "player/render/sheets/warp/sheet_image.h"
#include "player/render/view/shear.h"

namespace splatlas {
namespace {

/// One bilinear sample, as in the warp; zero outside the sheet's border.
Radiance sample(const SheetImage& sheet, double x, double y) {
  const SheetWindow& window = sheet.window;
  if (!(x > -1 && y > -1 && x < static_cast<double>(window.fine_columns()) &&
        y < static_cast<double>(window.fine_rows()))) {
    return {};
  }
  const double column = std::floor(x);
  const double row = std::floor(y);
  const float* upper = sheet.at(static_cast<std::int64_t>(column), static_cast<std::int64_t>(row));
  const std::array<float, 4> weights =
      sheet_weights(static_cast<float>(x - column), static_cast<float>(y - row), window.skew);
  return sheet_sample(upper, sheet.stride() * sheet.channels, sheet.channels, weights, sheet.color);
}

CubicWalk cubic_walk(const SheetImage& sheet, double x, double y, double step_x, double step_y) {
  return {sheet.at(0, 0),
          sheet.window.fine_columns(),
          sheet.window.fine_rows(),
          sheet.stride(),
          sheet.channels,
          sheet.color,
          x,
          y,
          step_x,
          step_y};
}

/// Box filter: mean over a grid of samples within the pixel with centre (x, y).
Radiance sample_mean(const SheetImage& sheet, const Affine2& map, double x, double y, int samples,
                     const WarpKernels& kernels) {
  Radiance sum;
  for (int v = 0; v < samples; ++v) {
    for (int u = 0; u < samples; ++u) {
      const double sx = x + (u + 0.5) / samples - 0.5;
      const double sy = y + (v + 0.5) / samples - 0.5;
      const double at_x = map.xx * sx + map.xy * sy + map.x0, at_y = map.yx * sx + map.yy * sy + map.y0;
      Radiance radiance;
      if (sheet.window.cubic) {
        kernels.cubic(cubic_walk(sheet, at_x, at_y, 0, 0), 1, radiance.rgba.data());
      } else {
        radiance = sample(sheet, at_x, at_y);
      }
      for (std::size_t c = 0; c < 4; ++c) sum.rgba[c] += radiance.rgba[c];
    }
  }
  const float scale = 1.0f / static_cast<float>(samples * samples);
  for (float& c : sum.rgba) c *= scale;
  return sum;
}

/// Pixels [first, last) of a row whose samples may overlap the sheet, padded by `margin` sheet pixels.
std::pair<int, int> covered(const SheetImage& sheet, const Affine2& map, double y, int width, double margin) {
  double first = 0;
  double last = width;
  const auto clip = [&](double per_x, double at_zero, double extent) {
    // Solve -1 - margin < per_x * x + at_zero < extent + margin
    const double low = -1 - margin - at_zero;
    const double high = extent + margin - at_zero;
    if (per_x == 0) {
      if (!(low < 0 && high > 0)) last = first;
      return;
    }
    first = std::max(first, std::floor(std::min(low / per_x, high / per_x)));
    last = std::min(last, std::ceil(std::max(low / per_x, high / per_x)) + 1);
  };
  clip(map.xx, map.xx * 0.5 + map.xy * y + map.x0, static_cast<double>(sheet.window.fine_columns()));
  clip(map.yx, map.yx * 0.5 + map.yy * y + map.y0, static_cast<double>(sheet.window.fine_rows()));
  if (!(first < last)) return {0, 0};
  return {static_cast<int>(first), static_cast<int>(last)};
}

struct Pixel {
  int column = 0, row = 0;
};

/// Mean of the samples [first, last) of a pixel.
Radiance mean_of(const FragmentsInVolume& fragments, std::uint32_t first, std::uint32_t last,
                 const SheetImage& sheet, const Affine2& map, const Pixel& pixel) {
  Radiance sum;
  for (std::uint32_t n = first; n < last; ++n) {
    // Point-sample the volume: the radiance in front of fragments is a point sample, too.
    const SubPixel& place = fragments.list.samples[n].place;
    const double x = pixel.column + place.right();
    const double y = pixel.row + place.down();
    Radiance radiance = fragments.samples[n].in(
        sample(sheet, map.xx * x + map.xy * y + map.x0, map.yx * x + map.yy * y + map.y0));
    if (fragments.faces != nullptr) radiance.rgba = fragments.list.faces[n].around(radiance.rgba);
    sum += radiance;
  }
  const float share = 1.0f / static_cast<float>(last - first);
  for (float& c : sum.rgba) c *= share;
  return sum;
}

/// The warp of a row of picture pixels.
class RowWarp {
 public:
  RowWarp(const SheetImage& sheet, const Affine2& map, int samples, double margin, const WarpKernels& kernels,
          double y, int width)
      : sheet_(sheet),
        map_(map),
        samples_(samples),
        cubic_(samples == 1 && sheet.window.cubic),
        kernels_(kernels),
        y_(y) {
    if (sheet.window.empty()) return;
    std::tie(first_, last_) = covered(sheet, map, y, width, margin);
    if (samples > 1 || cubic_) return;
    // Shrink by the fixed-point positions of the walk, so that all four neighbours of every sample exist.
    while (first_ < last_ && !inside(first_, first_)) ++first_;
    while (first_ < last_ && !inside(first_, last_ - 1)) --last_;
  }

  /// Columns [first, last) overlap the sheet.
  [[nodiscard]] int first() const { return first_; }
  [[nodiscard]] int last() const { return last_; }

  /// Warps columns [from, to), which must overlap the sheet; `out`: the first one.
  void warp(int from, int to, float* out) const {
    if (from >= to) return;
    if (cubic_) {
      const double x = from + 0.5;
      const CubicWalk walk = cubic_walk(sheet_, map_.xx * x + map_.xy * y_ + map_.x0,
                                        map_.yx * x + map_.yy * y_ + map_.y0, map_.xx, map_.yx);
      kernels_.cubic(walk, static_cast<std::size_t>(to - from), out);
      return;
    }
    if (samples_ == 1) {
      kernels_.warp(walk_from(from), static_cast<std::size_t>(to - from), out);
      return;
    }
    for (int column = from; column < to; ++column) {
      const Radiance radiance = sample_mean(sheet_, map_, column + 0.5, y_, samples_, kernels_);
      std::copy(radiance.rgba.begin(), radiance.rgba.end(), out + std::ptrdiff_t{4} * (column - from));
    }
  }

 private:
  static std::int64_t fixed(double value) {
    return static_cast<std::int64_t>(value * 4294967296.0 + (value < 0 ? -0.5 : 0.5));
  }

  [[nodiscard]] WarpWalk walk_from(int column) const {
    const double x = column + 0.5;
    return {sheet_.pixels.data(),
            sheet_.stride(),
            sheet_.channels,
            sheet_.color,
            sheet_.window.skew,
            fixed(map_.xx * x + map_.xy * y_ + map_.x0 + 1),
            fixed(map_.yx * x + map_.yy * y_ + map_.y0 + 1),
            fixed(map_.xx),
            fixed(map_.yx)};
  }
  /// True if a walk from `from` is inside the sheet at `column`, with a margin for accumulated rounding.
  [[nodiscard]] bool inside(int from, int column) const {
    constexpr std::int64_t kRounding = std::int64_t{1} << 16;
    const WarpWalk walk = walk_from(from);
    const std::int64_t steps = column - from;
    const auto within = [&](std::int64_t at, std::int64_t pixels) {
      return at >= (steps == 0 ? 0 : kRounding) && at < ((pixels + 1) << 32) - kRounding;
    };
    return within(walk.x + steps * walk.step_x, sheet_.window.fine_columns()) &&
           within(walk.y + steps * walk.step_y, sheet_.window.fine_rows());
  }

  const SheetImage& sheet_;
  const Affine2& map_;
  int samples_;
  bool cubic_;
  const WarpKernels& kernels_;
  double y_;
  int first_ = 0, last_ = 0;
};

/// Composites `count` pixels of the volume in front of those of the picture (Porter and Duff 1984).
void put_in_front(const float* volume, int count, float* picture) {
  for (int n = 0; n < count; ++n, volume += 4, picture += 4) {
    for (int c = 0; c < 4; ++c) picture[c] = volume[c] + (1 - volume[3]) * picture[c];
  }
}

/// Warps a region of the picture without surfaces, or in front of what is painted. Tiles improve locality:
/// adjacent rows sample the same part of the sheet, at any rotation.
void warp_rows(const SheetImage& sheet, const Affine2& map, int samples, const WarpKernels& kernels,
               const PixelBox& region, bool painted, Picture& picture) {
  constexpr int kTileColumns = 64;
  std::vector<RowWarp> rows;
  rows.reserve(static_cast<std::size_t>(region.height()));
  // Support of a pixel's filter beyond bilinear interpolation, in sheet pixels
  const double margin = (samples > 1 ? longest_step(map) : 0) + (sheet.window.cubic ? 1 : 0);
  for (int row = region.y_first; row <= region.y_last; ++row)
    rows.emplace_back(sheet, map, samples, margin, kernels, static_cast<double>(row) + 0.5,
                      picture.size.width);
  for (int tile = region.x_first; tile <= region.x_last; tile += kTileColumns) {
    const int tile_end = std::min(tile + kTileColumns, region.x_last + 1);
    for (int row = region.y_first; row <= region.y_last; ++row) {
      const RowWarp& warp = rows[static_cast<std::size_t>(row - region.y_first)];
      float* out = &picture.rgba[4 * picture.size.pixel(0, row)];
      const int from = std::clamp(warp.first(), tile, tile_end);
      const int to = std::clamp(warp.last(), from, tile_end);
      if (painted) {
        std::array<float, std::size_t{4} * kTileColumns> volume;
        warp.warp(from, to, volume.data());
        put_in_front(volume.data(), to - from, out + std::ptrdiff_t{4} * from);
        continue;
      }
      std::fill(out + std::ptrdiff_t{4} * tile, out + std::ptrdiff_t{4} * from, 0.0f);
      warp.warp(from, to, out + std::ptrdiff_t{4} * from);
      std::fill(out + std::ptrdiff_t{4} * to, out + std::ptrdiff_t{4} * tile_end, 0.0f);
    }
  }
}

/// Replaces the warped pixels of a row that have fragments.
void compose_row(const SheetImage& sheet, const Affine2& map, const FragmentsInVolume& fragments,
                 std::size_t row, Picture& picture) {
  const FragmentList& list = fragments.list;
  const auto width = static_cast<std::size_t>(picture.size.width);
  const std::uint32_t end = list.first_of_row[row + 1];
  for (std::uint32_t first = list.first_of_row[row]; first < end;) {
    std::uint32_t last = first + 1;
    while (last < end && list.samples[last].pixel == list.samples[first].pixel) ++last;
    const std::size_t pixel = list.samples[first].pixel;
    const auto column = static_cast<int>(pixel - row * width);
    const Radiance radiance = mean_of(fragments, first, last, sheet, map, {column, static_cast<int>(row)});
    std::copy(radiance.rgba.begin(), radiance.rgba.end(), &picture.rgba[4 * pixel]);
    first = last;
  }
}

}  // namespace

void resolve(const SheetImage& sheet, const Shear& shear, const FragmentsInVolume& fragments,
             const PixelBox& region, const WarpKernels& kernels, bool painted, Picture& picture,
             ThreadPool& pool) {
  constexpr std::int32_t kBandRows = 16;
  const auto width = static_cast<std::size_t>(picture.size.width);
  const Affine2 map = picture_to_pixels(shear, sheet.window);
  const int samples = samples_per_side(map, sheet.window);
  pool.for_each(static_cast<std::size_t>((region.height() + kBandRows - 1) / kBandRows), [&](std::size_t n) {
    PixelBox band = region;
    band.y_first += static_cast<std::int32_t>(n) * kBandRows;
    band.y_last = std::min(region.y_last, band.y_first + kBandRows - 1);
    warp_rows(sheet, map, samples, kernels, band, painted, picture);
    for (auto row = static_cast<std::size_t>(band.y_first); row <= static_cast<std::size_t>(band.y_last);
         ++row) {
      if (fragments.faces != nullptr) {
        fragments.faces->add_to_row(row, band.x_first, band.x_last + 1, &picture.rgba[4 * row * width]);
      }
      compose_row(sheet, map, fragments, row, picture);
    }
  });
}

}  // namespace splatlas
