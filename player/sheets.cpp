#include "player/sheets.h"

#include <algorithm>
#include <cmath>

#include "player/sheet_fragments.h"

namespace splatlas {
namespace {

constexpr std::int64_t kMostBandRows = 16;  // voxels: enough bands to share out
/// Bytes of accumulated image that a band works on: they stay in the second level cache.
constexpr std::int64_t kBandBytes = std::int64_t{1} << 18;

/// A shift split into whole pixels and the rest in [0, 1).
struct Offset {
  std::int64_t whole = 0;
  float part = 0;

  explicit Offset(double shift) {
    const double floor = std::floor(shift);
    whole = static_cast<std::int64_t>(floor);
    part = static_cast<float>(shift - floor);
  }
};

/// What all bands share.
struct Pass {
  const SpanModel& model;
  const Shear& shear;
  const SheetWindow& window;
  const SplatKernels& kernels;
  float floor;
  FragmentOrder& fragments;
  SheetImage& image;

  /// Floats of a plane of an image row: margins included, whole blocks.
  [[nodiscard]] std::int64_t stride() const {
    return (window.columns + 2 * ImageRow::kMargin + kBlock - 1) / kBlock * kBlock;
  }
};

/// Renders rows [first, last) of the window through all slices.
class Band {
 public:
  Band(const Pass& pass, std::int64_t first, std::int64_t last, SheetFragments& fragments)
      : pass_(pass),
        scale_(pass.window.scale),
        first_(first),
        last_(last),
        stride_(pass.stride()),
        fragments_(fragments) {
    const auto image_rows = static_cast<std::size_t>((last - first) * scale_ * scale_);
    image_.assign(image_rows * 4 * static_cast<std::size_t>(stride_), 0.0f);
  }

  void render() {
    const auto slices = static_cast<std::int64_t>(pass_.model.slices.size());
    for (std::int64_t n = 0; n < slices; ++n) {
      const std::int64_t slice = pass_.shear.ascending ? n : slices - 1 - n;
      if (!pass_.model.slices[static_cast<std::size_t>(slice)].spans.empty()) render_slice(slice);
    }
    for (std::int64_t row = first_ * scale_; row < last_ * scale_; ++row) {
      fragments_.finish(row, accumulated(row));
    }
    store();
  }

  [[nodiscard]] std::uint64_t voxels() const { return voxels_; }

 private:
  /// One row of a slice, for every phase.
  struct RowOfSlice {
    const SliceSpans& slice;
    std::span<const Span> near, far;
    float v_part;
    std::span<const Offset> phases;

    [[nodiscard]] SheetRow at_phase(std::int64_t phase) const {
      const Offset& u = phases[static_cast<std::size_t>(phase)];
      return {slice.light.get(), near, far, 1.0f - v_part, v_part, 1.0f - u.part, u.part, u.whole};
    }
  };

  /// Pixel 0 of the first plane.
  float* image_row(std::int64_t fine_row, std::int64_t phase) {
    return image_.data() + ((fine_row - first_ * scale_) * scale_ + phase) * 4 * stride_ + ImageRow::kMargin;
  }
  AccumulatedRow accumulated(std::int64_t fine_row) { return {image_row(fine_row, 0), stride_, 4 * stride_}; }

  void render_slice(std::int64_t n) {
    const SliceSpans& slice = pass_.model.slices[static_cast<std::size_t>(n)];
    const std::int64_t slice_number = pass_.model.slice_first + n;
    const auto k = static_cast<double>(slice_number);
    const double u_shift = pass_.shear.u_shift(k) - static_cast<double>(pass_.window.u0);
    const double v_shift = pass_.shear.v_shift(k) - static_cast<double>(pass_.window.v0);
    phases_.clear();
    for (std::int64_t phase = 0; phase < scale_; ++phase) {
      phases_.emplace_back(u_shift - static_cast<double>(phase) / static_cast<double>(scale_));
    }
    for (std::int64_t sub_row = 0; sub_row < scale_; ++sub_row) {
      const Offset v(v_shift - static_cast<double>(sub_row) / static_cast<double>(scale_));
      // Voxel row j is seen between rows j + v.whole and j + v.whole + 1.
      const std::int64_t first = std::max(first_, pass_.model.row_first + v.whole);
      const std::int64_t last = std::min(last_, pass_.model.row_first + pass_.model.rows + v.whole + 1);
      for (std::int64_t row = first; row < last; ++row) {
        const auto near = pass_.model.row(slice, row - v.whole);
        if (sub_row == 0) {
          for (const Span& span : near) voxels_ += span.voxels;
        }
        const auto far = v.part > 0 ? pass_.model.row(slice, row - v.whole - 1) : std::span<const Span>();
        if (near.empty() && far.empty()) continue;
        const RowOfSlice row_of_slice{slice, near, far, v.part, phases_};
        const std::int64_t fine_row = row * scale_ + sub_row;
        fragments_.before_slab(fine_row, pass_.fragments.slab_of(slice_number), accumulated(fine_row));
        composite(row_of_slice, fine_row);
        fragments_.behind_slab(fine_row, accumulated(fine_row));
      }
    }
  }

  void composite(const RowOfSlice& row, std::int64_t fine_row) {
    const auto slab_mm = static_cast<float>(pass_.shear.slab_mm);
    for (std::int64_t phase = 0; phase < scale_; ++phase) {
      pass_.kernels.composite(
          row.at_phase(phase), slab_mm, pass_.floor,
          {image_row(fine_row, phase), static_cast<std::size_t>(stride_), pass_.window.columns});
    }
  }

  /// Interleaves the phases into the finished sheet.
  void store() {
    const std::int64_t fine_columns = pass_.window.fine_columns();
    for (std::int64_t fine_row = first_ * scale_; fine_row < last_ * scale_; ++fine_row) {
      Light* out = &pass_.image.pixels[static_cast<std::size_t>((fine_row + 1) * (fine_columns + 2) + 1)];
      for (std::int64_t phase = 0; phase < scale_; ++phase) {
        const float* image = image_row(fine_row, phase);
        for (std::int64_t x = 0; x < pass_.window.columns; ++x) {
          out[x * scale_ + phase] = {
              {image[x], image[stride_ + x], image[2 * stride_ + x], image[3 * stride_ + x]}};
        }
      }
    }
  }

  const Pass& pass_;
  std::int64_t scale_, first_, last_, stride_;
  std::vector<float> image_;    // [fine row][phase][red, green, blue, opacity][stride]
  std::vector<Offset> phases_;  // of the current slice
  SheetFragments& fragments_;
  std::uint64_t voxels_ = 0;
};

}  // namespace

SheetWindow sheet_window(const SpanModel& model, const Shear& shear, const PictureSize& size, int scale) {
  SheetWindow window;
  window.scale = scale;
  if (model.voxels == 0) return window;
  // Where voxels are seen: a footprint reaches one voxel to each side.
  const auto seen = [&](double first, double voxels, double shift_first, double shift_last) {
    return std::pair(first - 1 + std::min(shift_first, shift_last),
                     first + voxels + std::max(shift_first, shift_last));
  };
  const auto k_first = static_cast<double>(model.slice_first);
  const auto k_last = k_first + static_cast<double>(model.slices.size()) - 1;
  auto [u_min, u_max] = seen(static_cast<double>(model.scan_first), static_cast<double>(model.scan_voxels),
                             shear.u_shift(k_first), shear.u_shift(k_last));
  auto [v_min, v_max] = seen(static_cast<double>(model.row_first), static_cast<double>(model.rows),
                             shear.v_shift(k_first), shear.v_shift(k_last));
  // What the picture shows, one voxel more for interpolation.
  const Affine2& map = shear.picture_to_sheet;
  const auto shown = [&](double per_x, double per_y, double origin) {
    const double x = per_x * size.width;
    const double y = per_y * size.height;
    return std::pair(origin + std::min(x, 0.0) + std::min(y, 0.0) - 1,
                     origin + std::max(x, 0.0) + std::max(y, 0.0) + 1);
  };
  const auto [u_low, u_high] = shown(map.xx, map.xy, map.x0);
  const auto [v_low, v_high] = shown(map.yx, map.yy, map.y0);
  u_min = std::max(u_min, u_low);
  u_max = std::min(u_max, u_high);
  v_min = std::max(v_min, v_low);
  v_max = std::min(v_max, v_high);
  if (!(u_min < u_max && v_min < v_max)) return window;
  window.u0 = static_cast<std::int64_t>(std::floor(u_min));
  window.v0 = static_cast<std::int64_t>(std::floor(v_min));
  window.columns = static_cast<std::int64_t>(std::ceil(u_max)) - window.u0 + 1;
  window.rows = static_cast<std::int64_t>(std::ceil(v_max)) - window.v0 + 1;
  return window;
}

SheetCounters render_sheets(const SpanModel& model, const Shear& shear, const SheetWindow& window,
                            const SplatKernels& kernels, float floor, FragmentOrder& fragments,
                            SheetImage& image, ThreadPool& pool) {
  image.window = window;
  image.pixels.assign(static_cast<std::size_t>((window.fine_rows() + 2) * (window.fine_columns() + 2)),
                      Light{});
  const Pass pass{model, shear, window, kernels, floor, fragments, image};
  const std::int64_t row_bytes = pass.stride() * window.scale * window.scale * std::int64_t{sizeof(Light)};
  const std::int64_t band_rows =
      std::clamp<std::int64_t>(kBandBytes / std::max<std::int64_t>(row_bytes, 1), 1, kMostBandRows);
  std::vector<SheetFragments> band_fragments;
  for (std::int64_t row = 0; row < window.rows; row += band_rows) {
    const std::int64_t last = std::min(row + band_rows, window.rows);
    band_fragments.emplace_back(fragments, row * window.scale, last * window.scale, window.scale);
  }
  std::vector<std::uint64_t> voxels(band_fragments.size(), 0);
  pool.for_each(voxels.size(), [&](std::size_t n) {
    const std::int64_t first = static_cast<std::int64_t>(n) * band_rows;
    Band band(pass, first, std::min(first + band_rows, window.rows), band_fragments[n]);
    band.render();
    voxels[n] = band.voxels();
  });
  for (SheetFragments& of_band : band_fragments) of_band.merge();
  SheetCounters counters;
  for (const std::uint64_t v : voxels) counters.voxels += v;
  return counters;
}

}  // namespace splatlas
