#include "player/sheets.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "player/fragment_order.h"

namespace splatlas {
namespace {

constexpr std::int64_t kBlock = kSpanPadding;  // pixels composited together
constexpr std::int64_t kBandRows = 16;  // voxels: small enough for the cache, large enough to share out

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

/// Blocks of one row of the sheet that something was splatted into.
class TouchedBlocks {
 public:
  void resize(std::int64_t blocks) { words_.assign(static_cast<std::size_t>(blocks + 63) / 64, 0); }

  void mark(std::int64_t first_pixel, std::int64_t pixels) {
    const std::int64_t last = (first_pixel + pixels - 1) / kBlock;
    for (std::int64_t block = first_pixel / kBlock; block <= last; ++block) {
      words_[static_cast<std::size_t>(block / 64)] |= std::uint64_t{1} << (block % 64);
    }
  }
  /// Calls visit(first pixel, pixels) for every stretch of touched blocks, and forgets them.
  template <typename Visit>
  void take(Visit&& visit) {
    for (std::size_t word = 0; word < words_.size(); ++word) {
      std::uint64_t bits = std::exchange(words_[word], 0);
      while (bits != 0) {
        const int first = std::countr_zero(bits);
        const int count = std::countr_one(bits >> first);
        visit((static_cast<std::int64_t>(word) * 64 + first) * kBlock, count * kBlock);
        if (first + count == 64) break;
        bits &= ~std::uint64_t{0} << (first + count);
      }
    }
  }

 private:
  std::vector<std::uint64_t> words_;
};

/// What all bands share.
struct Pass {
  const SpanModel& model;
  const Shear& shear;
  const SheetWindow& window;
  const SplatKernels& kernels;
  const FragmentOrder& order;
  FragmentList& fragments;
  SheetImage& image;

  [[nodiscard]] std::int64_t stride() const {
    return (window.columns + kBlock - 1) / kBlock * kBlock + kBlock;
  }
};

/// Renders rows [first, last) of the window through all slices.
class Band {
 public:
  Band(const Pass& pass, std::int64_t first, std::int64_t last)
      : pass_(pass), scale_(pass.window.scale), first_(first), last_(last), stride_(pass.stride()) {
    const auto fine_rows = static_cast<std::size_t>((last - first) * scale_);
    const auto row_floats = static_cast<std::size_t>(scale_ * 4 * stride_);
    image_.assign(fine_rows * row_floats, 0.0f);
    sheet_.assign(row_floats, 0.0f);
    touched_.resize(static_cast<std::size_t>(scale_));
    for (TouchedBlocks& blocks : touched_) blocks.resize(stride_ / kBlock);
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
      take_fragments(row, FragmentOrder::kBehindEverything);
    }
    store();
  }

  [[nodiscard]] std::uint64_t voxels() const { return voxels_; }

 private:
  struct Cursors {
    std::size_t above = 0, below = 0;  ///< next fragments whose upper, lower neighbour this row is
  };

  float* sheet_row(std::int64_t phase) { return sheet_.data() + phase * 4 * stride_; }
  float* image_row(std::int64_t fine_row, std::int64_t phase) {
    return image_.data() + ((fine_row - first_ * scale_) * scale_ + phase) * 4 * stride_;
  }

  void render_slice(std::int64_t n) {
    const SliceSpans& slice = pass_.model.slices[static_cast<std::size_t>(n)];
    const std::int64_t slice_number = pass_.model.slice_first + n;
    const auto k = static_cast<double>(slice_number);
    const double u_shift = pass_.shear.u_shift(k) - static_cast<double>(pass_.window.u0);
    const double v_shift = pass_.shear.v_shift(k) - static_cast<double>(pass_.window.v0);
    for (std::int64_t sub_row = 0; sub_row < scale_; ++sub_row) {
      const Offset v(v_shift - static_cast<double>(sub_row) / static_cast<double>(scale_));
      // Voxel row j is seen between rows j + v.whole and j + v.whole + 1.
      const std::int64_t first = std::max(first_, pass_.model.row_first + v.whole);
      const std::int64_t last = std::min(last_, pass_.model.row_first + pass_.model.rows + v.whole + 1);
      for (std::int64_t row = first; row < last; ++row) {
        const auto near = pass_.model.row(slice, row - v.whole);
        const auto far = pass_.model.row(slice, row - v.whole - 1);
        if (near.empty() && far.empty()) continue;
        if (sub_row == 0) {
          for (const Span& span : near) voxels_ += span.voxels;
        }
        for (std::int64_t phase = 0; phase < scale_; ++phase) {
          const Offset u(u_shift - static_cast<double>(phase) / static_cast<double>(scale_));
          splat_row(slice, near, 1.0f - v.part, u, phase);
          splat_row(slice, far, v.part, u, phase);
        }
        const std::int64_t fine_row = row * scale_ + sub_row;
        take_fragments(fine_row, pass_.order.slab_of(slice_number));
        composite_row(fine_row);
      }
    }
  }

  void splat_row(const SliceSpans& slice, std::span<const Span> spans, float weight, const Offset& u,
                 std::int64_t phase) {
    if (weight == 0) return;
    const float here = weight * (1.0f - u.part);
    const float before = weight * u.part;
    for (const Span& span : spans) {
      // One pixel more than voxels: the last voxel's footprint.
      std::int64_t x = span.start + u.whole;
      std::int64_t count = span.length + 1;
      const float* light = slice.planes.get() + span.offset;
      // Vector steps may run past the span's end, into its padding; but not where a cut at the left has put
      // them out of step with it.
      std::int64_t whole_steps = count;
      if (x < 0) {
        count += x;
        light -= x;
        x = 0;
        whole_steps = count / kBlock * kBlock;
      }
      const bool clipped = count > pass_.window.columns - x;
      if (clipped) count = pass_.window.columns - x;
      if (count <= 0) continue;
      whole_steps = std::min(whole_steps, count);
      float* row = sheet_row(phase) + x;
      pass_.kernels.splat(light, slice.plane_floats, static_cast<std::size_t>(whole_steps), here, before, row,
                          static_cast<std::size_t>(stride_));
      if (whole_steps < count) {
        scalar_kernels().splat(light + whole_steps, slice.plane_floats,
                               static_cast<std::size_t>(count - whole_steps), here, before, row + whole_steps,
                               static_cast<std::size_t>(stride_));
      }
      // Past a cut the padding is not zero: have that cleared, too.
      touched_[static_cast<std::size_t>(phase)].mark(x, clipped ? stride_ - x : count);
    }
  }

  void composite_row(std::int64_t fine_row) {
    const auto slab_mm = static_cast<float>(pass_.shear.slab_mm);
    for (std::int64_t phase = 0; phase < scale_; ++phase) {
      float* sheet = sheet_row(phase);
      float* image = image_row(fine_row, phase);
      touched_[static_cast<std::size_t>(phase)].take([&](std::int64_t first, std::int64_t pixels) {
        pass_.kernels.composite(sheet + first, static_cast<std::size_t>(stride_),
                                static_cast<std::size_t>(pixels), slab_mm, image + first,
                                static_cast<std::size_t>(stride_));
      });
    }
  }

  /// Hands the volume in front of them to the fragments next to this row, up to and including those in
  /// `slab`.
  void take_fragments(std::int64_t fine_row, std::int32_t slab) {
    Cursors& cursors = cursors_[static_cast<std::size_t>(fine_row - first_ * scale_)];
    const FragmentOrder& order = pass_.order;
    for (; cursors.above < order.row_end(fine_row) && order.entry(cursors.above).slab <= slab;
         ++cursors.above) {
      const FragmentOrder::Entry& entry = order.entry(cursors.above);
      pass_.fragments.above[entry.fragment] =
          light_before(entry, fine_row, 1.0f - entry.y_part, entry.slab == slab ? entry.slab_part : 0.0f);
    }
    for (; cursors.below < order.row_end(fine_row - 1) && order.entry(cursors.below).slab <= slab;
         ++cursors.below) {
      const FragmentOrder::Entry& entry = order.entry(cursors.below);
      pass_.fragments.below[entry.fragment] =
          light_before(entry, fine_row, entry.y_part, entry.slab == slab ? entry.slab_part : 0.0f);
    }
  }

  /// This row's share (`weight`) of the volume in front of a fragment, `part` of the current slab included.
  Light light_before(const FragmentOrder::Entry& entry, std::int64_t fine_row, float weight, float part) {
    Light sum;
    for (const std::int64_t side : {0, 1}) {
      const float share = weight * (side == 0 ? 1.0f - entry.x_part : entry.x_part);
      const Light pixel = pixel_before(entry.x + side, fine_row, part);
      for (std::size_t c = 0; c < 4; ++c) sum.rgba[c] += share * pixel.rgba[c];
    }
    return sum;
  }

  Light pixel_before(std::int64_t x, std::int64_t fine_row, float part) {
    Light light;
    if (x < 0 || x >= pass_.window.fine_columns()) return light;
    const std::int64_t phase = x % scale_;
    const float* image = image_row(fine_row, phase) + x / scale_;
    light = {{image[0], image[stride_], image[2 * stride_], image[3 * stride_]}};
    if (part <= 0) return light;
    const float* sheet = sheet_row(phase) + x / scale_;
    const float length = part * static_cast<float>(pass_.shear.slab_mm);
    const float depth = sheet[0] * length;
    if (depth <= 0) return light;
    const float through = 1 - light.rgba[3];
    const float absorbed = -std::expm1(-depth);
    const float weight = through * length * (absorbed / depth);
    for (std::int64_t c = 0; c < 3; ++c)
      light.rgba[static_cast<std::size_t>(c)] += weight * sheet[(c + 1) * stride_];
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
  std::vector<float> image_;            // [fine row][phase][red, green, blue, opacity][stride]
  std::vector<float> sheet_;            // one row: [phase][extinction, red, green, blue][stride]
  std::vector<TouchedBlocks> touched_;  // per phase
  std::vector<Cursors> cursors_;        // per fine row
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
                            FragmentList& fragments, SheetImage& image, ThreadPool& pool) {
  image.window = window;
  image.pixels.assign(static_cast<std::size_t>((window.fine_rows() + 2) * (window.fine_columns() + 2)),
                      Light{});
  const FragmentOrder order(fragments, shear, window, size, grid, pool);
  const Pass pass{model, shear, window, kernels, order, fragments, image};
  const std::int64_t bands = (window.rows + kBandRows - 1) / kBandRows;
  std::vector<std::uint64_t> voxels(static_cast<std::size_t>(bands), 0);
  pool.for_each(voxels.size(), [&](std::size_t n) {
    const std::int64_t first = static_cast<std::int64_t>(n) * kBandRows;
    Band band(pass, first, std::min(first + kBandRows, window.rows));
    band.render();
    voxels[n] = band.voxels();
  });
  SheetCounters counters;
  for (const std::uint64_t v : voxels) counters.voxels += v;
  return counters;
}

}  // namespace splatlas
