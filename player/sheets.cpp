#include "player/sheets.h"

#include <algorithm>
#include <cmath>

#include "player/fragment_order.h"

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
  const FragmentOrder& order;
  float floor;
  FragmentList& fragments;
  SheetImage& image;

  /// Floats of a plane of an image row: margins included, whole blocks.
  [[nodiscard]] std::int64_t stride() const {
    return (window.columns + 2 * ImageRow::kMargin + kBlock - 1) / kBlock * kBlock;
  }
};

/// What one plane of a slice shows in a pixel of the sheet: what the kernels splat there.
float splatted(const SheetRow& row, Plane plane, std::int64_t x) {
  const auto light = [&](std::span<const Span> spans, std::int64_t at) {
    const auto after =
        std::upper_bound(spans.begin(), spans.end(), at >> kBlockBits,
                         [](std::int64_t block, const Span& span) { return block < span.first_block; });
    if (after == spans.begin()) return 0.0f;
    const Span& span = *(after - 1);
    if (at >> kBlockBits >= static_cast<std::int64_t>(span.first_block) + span.blocks) return 0.0f;
    return row.light[span.place(static_cast<std::uint32_t>(at)) + static_cast<std::size_t>(plane) * kBlock];
  };
  const auto mixed = [&](std::int64_t at) {
    return row.near_weight * light(row.near, at) + row.far_weight * light(row.far, at);
  };
  return row.here * mixed(x - row.shift) + row.before * mixed(x - row.shift - 1);
}

/// Renders rows [first, last) of the window through all slices.
class Band {
 public:
  Band(const Pass& pass, std::int64_t first, std::int64_t last)
      : pass_(pass), scale_(pass.window.scale), first_(first), last_(last), stride_(pass.stride()) {
    const auto fine_rows = static_cast<std::size_t>((last - first) * scale_);
    const auto image_rows = fine_rows * static_cast<std::size_t>(scale_);
    image_.assign(image_rows * 4 * static_cast<std::size_t>(stride_), 0.0f);
    cursors_.resize(fine_rows);
    for (std::size_t n = 0; n < fine_rows; ++n) {
      const std::int64_t row = first_ * scale_ + static_cast<std::int64_t>(n);
      cursors_[n] = {pass.order.row_begin(row), pass.order.row_begin(row - 1)};
    }
  }

  void render() {
    const auto slices = static_cast<std::int64_t>(pass_.model.slices.size());
    for (std::int64_t n = 0; n < slices; ++n) {
      const std::int64_t slice = pass_.shear.ascending ? n : slices - 1 - n;
      if (!pass_.model.slices[static_cast<std::size_t>(slice)].spans.empty()) render_slice(slice);
    }
    for (std::int64_t row = first_ * scale_; row < last_ * scale_; ++row) {
      take_fragments(row, FragmentOrder::kBehindEverything, nullptr);
    }
    store();
  }

  [[nodiscard]] std::uint64_t voxels() const { return voxels_; }

 private:
  struct Cursors {
    std::size_t above = 0, below = 0;  ///< next fragments whose upper, lower neighbour this row is
  };
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
        take_fragments(fine_row, pass_.order.slab_of(slice_number), &row_of_slice);
        composite(row_of_slice, fine_row);
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

  /// Hands the volume in front of them to the fragments next to this row, up to and including those in
  /// `slab`, which `row` (if any) is the light of.
  void take_fragments(std::int64_t fine_row, std::int32_t slab, const RowOfSlice* row) {
    Cursors& cursors = cursors_[static_cast<std::size_t>(fine_row - first_ * scale_)];
    const FragmentOrder& order = pass_.order;
    for (; cursors.above < order.row_end(fine_row) && order.entry(cursors.above).slab <= slab;
         ++cursors.above) {
      const FragmentOrder::Entry& entry = order.entry(cursors.above);
      pass_.fragments.above[entry.fragment] =
          light_before(entry, fine_row, 1.0f - entry.y_part, entry.slab == slab ? row : nullptr);
    }
    for (; cursors.below < order.row_end(fine_row - 1) && order.entry(cursors.below).slab <= slab;
         ++cursors.below) {
      const FragmentOrder::Entry& entry = order.entry(cursors.below);
      pass_.fragments.below[entry.fragment] =
          light_before(entry, fine_row, entry.y_part, entry.slab == slab ? row : nullptr);
    }
  }

  /// This row's share (`weight`) of the volume in front of a fragment, its part of slab `row` included.
  Light light_before(const FragmentOrder::Entry& entry, std::int64_t fine_row, float weight,
                     const RowOfSlice* row) {
    Light sum;
    for (const std::int64_t side : {0, 1}) {
      const float share = weight * (side == 0 ? 1.0f - entry.x_part : entry.x_part);
      const Light pixel = pixel_before(entry.x + side, fine_row, entry.slab_part, row);
      for (std::size_t c = 0; c < 4; ++c) sum.rgba[c] += share * pixel.rgba[c];
    }
    return sum;
  }

  Light pixel_before(std::int64_t x, std::int64_t fine_row, float part, const RowOfSlice* row) {
    Light light;
    if (x < 0 || x >= pass_.window.fine_columns()) return light;
    const std::int64_t phase = x % scale_;
    const float* image = image_row(fine_row, phase) + x / scale_;
    light = {{image[0], image[stride_], image[2 * stride_], image[3 * stride_]}};
    if (row == nullptr || part <= 0) return light;
    const SheetRow sheet = row->at_phase(phase);
    const float length = part * static_cast<float>(pass_.shear.slab_mm);
    const float depth = splatted(sheet, Plane::kExtinction, x / scale_) * length;
    if (depth <= 0) return light;
    const float through = 1 - light.rgba[3];
    const float absorbed = -std::expm1(-depth);
    const float weight = through * length * (absorbed / depth);
    for (std::size_t c = 0; c < 3; ++c)
      light.rgba[c] += weight * splatted(sheet, static_cast<Plane>(c + 1), x / scale_);
    light.rgba[3] += through * absorbed;
    return light;
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
  std::vector<float> image_;      // [fine row][phase][red, green, blue, opacity][stride]
  std::vector<Cursors> cursors_;  // per fine row
  std::vector<Offset> phases_;    // of the current slice
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
                            const PictureSize& size, const Grid& grid, const SplatKernels& kernels,
                            float floor, FragmentList& fragments, SheetImage& image, ThreadPool& pool) {
  image.window = window;
  image.pixels.assign(static_cast<std::size_t>((window.fine_rows() + 2) * (window.fine_columns() + 2)),
                      Light{});
  const FragmentOrder order(fragments, shear, window, size, grid, pool);
  const Pass pass{model, shear, window, kernels, order, floor, fragments, image};
  const std::int64_t row_bytes = pass.stride() * window.scale * window.scale * std::int64_t{sizeof(Light)};
  const std::int64_t band_rows =
      std::clamp<std::int64_t>(kBandBytes / std::max<std::int64_t>(row_bytes, 1), 1, kMostBandRows);
  const std::int64_t bands = (window.rows + band_rows - 1) / band_rows;
  std::vector<std::uint64_t> voxels(static_cast<std::size_t>(bands), 0);
  pool.for_each(voxels.size(), [&](std::size_t n) {
    const std::int64_t first = static_cast<std::int64_t>(n) * band_rows;
    Band band(pass, first, std::min(first + band_rows, window.rows));
    band.render();
    voxels[n] = band.voxels();
  });
  SheetCounters counters;
  for (const std::uint64_t v : voxels) counters.voxels += v;
  return counters;
}

}  // namespace splatlas
