#include "player/render/sheets/sheets.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "format/tasks/task_control.h"
#include "player/render/clip/clip_slabs.h"
#include "player/render/sheets/band_image.h"
#include "player/render/sheets/ids/sheet_shares.h"
#include "player/render/sheets/sheet_fragments.h"
#include "player/render/sheets/splat/slice_mix.h"
#include "player/render/view/sheet_window.h"

namespace splatlas {
namespace {

constexpr std::int64_t kMaxBandRows = 16;  // in voxels; small enough for load balance
/// Maximum size of a band's accumulation buffer, which should fit the L2 cache.
constexpr std::int64_t kBandBytes = std::int64_t{1} << 18;

/// A shift split into whole pixels and a fraction in [0, 1).
struct Offset {
  std::int64_t whole = 0;
  float part = 0;

  explicit Offset(double shift) {
    const double floor = std::floor(shift);
    whole = static_cast<std::int64_t>(floor);
    part = static_cast<float>(shift - floor);
  }
};

/// Arguments of render_sheets(), shared by all bands.
struct Pass {
  const SpanModel& model;
  const Shear& shear;
  const SheetWindow& window;
  const SplatKernels& kernels;
  float termination_threshold;
  const ClipSlabs* kept;  // null without a cut
  FragmentOrder& fragments;
  SheetImage& image;
  const SharePass* shares;  // null: not asked for
};

/// Memory of a band, reused: page faults would cost more than the band.
struct BandMemory {
  std::vector<float> floats;
  BandNumbers numbers;
  BandShares shares;
};

/// out[n * kRows + r] = rows[r][n].
template <std::size_t kRows>
void interleave(const float* const* rows, std::int64_t count, float* out) {
  for (std::int64_t n = 0; n < count; ++n) {
    for (std::size_t r = 0; r < kRows; ++r) out[static_cast<std::size_t>(n) * kRows + r] = rows[r][n];
  }
}

void interleave(std::span<const float* const> rows, std::int64_t count, float* out) {
  switch (rows.size()) {
    case 2: return interleave<2>(rows.data(), count, out);
    case 4: return interleave<4>(rows.data(), count, out);
    case 8: return interleave<8>(rows.data(), count, out);
    default: break;
  }
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (std::int64_t n = 0; n < count; ++n) out[static_cast<std::size_t>(n) * rows.size() + r] = rows[r][n];
  }
}

/// Rendering of rows [first, last) of the window through all slices, front to back.
class Band {
 public:
  Band(const Pass& pass, std::int64_t first, std::int64_t last, SheetFragments& fragments, BandMemory& memory)
      : pass_(pass),
        scale_(pass.window.scale),
        group_(static_cast<std::int64_t>(SheetRows::group_size(pass.window.scale))),
        first_(first),
        last_(last),
        image_(pass.window, pass.model.emissions, first, last, memory.floats),
        fragments_(fragments),
        numbers_(memory.numbers),
        shares_(memory.shares) {
    if (pass.shares == nullptr) return;
    numbers_.begin(pass.shares->numbers, pass.shear, pass.window, image_);
    shares_.begin(pass.window, image_);
  }

  void render() {
    const bool around_slices = pass_.window.parts == 1;
    std::int64_t next = -1;  // first interval that is not rendered yet
    const std::vector<SliceSpans>& slices = pass_.model.slices;
    for (std::size_t place = 0; place < slices.size(); ++place) {
      const SliceSpans& slice = slices[pass_.shear.ascending ? place : slices.size() - 1 - place];
      if (slice.spans.empty()) continue;
      const std::int64_t n = from_viewer(slice.number - pass_.model.slice_first);
      if (around_slices) {
        if (pass_.shares != nullptr) numbers_.select({&slice, nullptr, 0});
        render_slab(slice, static_cast<double>(slice.number));
        continue;
      }
      for (next = std::max(next, n - 1); next <= n; ++next) render_between(next);
    }
    if (!pass_.fragments.empty()) {
      for (std::int64_t row = image_.first_fine_row(); row < image_.last_fine_row(); ++row)
        fragments_.finish(row, accumulated(row));
    }
    store();
  }

 private:
  /// Maps the n-th slice of the model to its rank from the viewer, 0 for the nearest, and back.
  [[nodiscard]] std::int64_t from_viewer(std::int64_t n) const {
    return pass_.shear.ascending ? n : pass_.model.slice_count - 1 - n;
  }
  /// The model's n-th slice from the viewer; null if it is empty or outside the model.
  [[nodiscard]] const SliceSpans* slice(std::int64_t n) const {
    return pass_.model.slice(pass_.model.slice_first + from_viewer(n));
  }
  /// Position along the principal axis of slice n from the viewer; n may be fractional.
  [[nodiscard]] double place_of(double n) const {
    const double of_model = pass_.shear.ascending ? n : static_cast<double>(pass_.model.slice_count) - 1 - n;
    return static_cast<double>(pass_.model.slice_first) + of_model;
  }

  /// Renders the interpolated slabs between slice n and the next one.
  void render_between(std::int64_t n) {
    static thread_local SliceSpans mixed;
    SlicePair pair{slice(n), slice(n + 1), 0};
    if (pair.before == nullptr && pair.behind == nullptr) return;
    for (int part = 0; part < pass_.window.parts; ++part) {
      const double middle = (part + 0.5) / pass_.window.parts;
      const double k = place_of(static_cast<double>(n) + middle);
      pair.behind_weight = static_cast<float>(middle);
      if (removes(k)) continue;
      const SliceRows rows(pass_.shear, pass_.window, k);
      const std::int64_t first = rows.upper_from(scale_ - 1, image_.first_fine_row());
      const std::int64_t last = rows.upper_from(0, image_.last_fine_row()) + 1;
      list_visible_voxels(k, first, last);
      mix_slices(pair, first, last, visible_, pass_.kernels, mixed);
      if (mixed.spans.empty()) continue;
      if (pass_.shares != nullptr) numbers_.select(pair);
      render_slab(mixed, k);
    }
  }

  /// True if a plane removes the whole slab.
  [[nodiscard]] bool removes(double k) const {
    return pass_.kept != nullptr && pass_.kept->state(k, image_.first_fine_row(), image_.last_fine_row()) ==
                                        ClipSlabs::State::kRemoved;
  }
  /// Voxels of rows [first, last) that cut slabs show; none without a cut.
  void list_visible_voxels(double k, std::int64_t first, std::int64_t last) {
    visible_.clear();
    if (pass_.kept == nullptr) return;
    for (std::int64_t row = first; row < last; ++row) {
      const auto [first_voxel, last_voxel] = pass_.kept->visible_voxels(k, row);
      visible_.push_back({first_voxel >> kBlockBits, (last_voxel + kBlock - 1) >> kBlockBits});
    }
  }

  /// Splats and composites a slab at position `k` along the principal axis.
  void render_slab(const SliceSpans& slice, double k) {
    check_task();
    if (removes(k)) return;
    // Find the sub-pixel offset of each phase
    const double u_shift = pass_.shear.u_shift(k) - static_cast<double>(pass_.window.u0);
    phases_.clear();
    for (std::int64_t phase = 0; phase < scale_; ++phase) {
      const Offset u(u_shift - static_cast<double>(phase) / static_cast<double>(scale_));
      phases_.push_back({u.part, u.whole});
    }

    // Render the fine rows in groups
    const SliceRows rows(pass_.shear, pass_.window, k);
    for (std::int64_t between = 0; between < scale_;) {
      const std::int64_t count = std::min<std::int64_t>(group_, scale_ - between);
      render_rows(slice, k, rows, between, count);
      between += count;
    }
  }

  /// Renders fine rows [between, between + count) of every pair of voxel rows. Rows at the border of the band
  /// may lack the others of their group.
  void render_rows(const SliceSpans& slice, double k, const SliceRows& rows, std::int64_t between,
                   std::int64_t count) {
    // Find the pairs whose fine rows are all within the band
    const auto upper_rows = [&](std::int64_t row) {
      return std::pair(std::max(slice.first_row - 1, rows.upper_from(row, image_.first_fine_row())),
                       std::min(slice.last_row, rows.upper_from(row, image_.last_fine_row())));
    };
    auto [first, last] = upper_rows(between);
    for (std::int64_t row = between + 1; row < between + count; ++row) {
      const auto [own_first, own_last] = upper_rows(row);
      first = std::max(first, own_first);
      last = std::min(last, own_last);
    }

    // Composite single rows at the border, then all complete groups
    for (std::int64_t row = between; row < between + count; ++row) {
      const auto [own_first, own_last] = upper_rows(row);
      composite(slice, k, rows, row, 1, own_first, std::min(first, own_last));
      composite(slice, k, rows, row, 1, std::max({first, last, own_first}), own_last);
    }
    composite(slice, k, rows, between, count, first, last);
  }

  /// Composites `count` fine rows of the pairs with upper voxel rows [first, last).
  void composite(const SliceSpans& slice, double k, const SliceRows& slice_rows, std::int64_t between,
                 std::int64_t count, std::int64_t first, std::int64_t last) {
    if (first >= last) return;
    const std::int64_t fine_row = slice_rows.fine_row(first, between);
    const ClipSlabs::State state_of_all =
        pass_.kept == nullptr ? ClipSlabs::State::kWhole
                              : pass_.kept->state(k, fine_row, fine_row + (last - first) * scale_);
    if (state_of_all == ClipSlabs::State::kWhole)
      return composite_kept(slice, k, slice_rows, between, count, first, last, {});
    if (state_of_all == ClipSlabs::State::kRemoved) return;
    // Split the pairs by removed, cut and whole rows
    kept_.fill(*pass_.kept, k, fine_row, last - first, count);
    for (std::int64_t begin = first, end = first; begin < last; begin = end) {
      const ClipSlabs::State state = kept_.state(begin - first);
      while (end < last && kept_.state(end - first) == state) ++end;
      if (state == ClipSlabs::State::kRemoved) continue;
      composite_kept(slice, k, slice_rows, between, count, begin, end,
                     state == ClipSlabs::State::kCut ? kept_.from(begin - first, 0) : ClipRows{});
    }
  }

  /// The same for pairs that all are cut, as `clip` describes, or all whole.
  void composite_kept(const SliceSpans& slice, double k, const SliceRows& slice_rows, std::int64_t between,
                      std::int64_t count, std::int64_t first, std::int64_t last, const ClipRows& clip) {
    SheetRows rows;
    rows.slice = &slice;
    rows.upper = first;
    rows.pairs = last - first;
    rows.rows_between = static_cast<std::size_t>(count);
    for (std::int64_t row = 0; row < count; ++row)
      rows.lower_weights[static_cast<std::size_t>(row)] = slice_rows.lower_weight(between + row);

    // Composite groups of phases between updates of the fragments
    const std::int64_t fine_row = slice_rows.fine_row(first, between);
    const std::int32_t slab = pass_.fragments.slab_of(k);
    for_each_row_with_fragments(
        rows, fine_row, [&](std::int64_t row) { fragments_.before_slab(row, slab, accumulated(row)); });
    for (std::size_t phase = 0; phase < phases_.size(); phase += rows.phase_count) {
      rows.phase_count = std::min<std::size_t>(group_, phases_.size() - phase);
      std::copy_n(phases_.begin() + static_cast<std::ptrdiff_t>(phase), rows.phase_count,
                  rows.phases.begin());
      const auto slab_mm = static_cast<float>(pass_.shear.slab_mm / pass_.window.parts);
      ClipRows of_phases = clip;
      of_phases.lines += static_cast<std::int64_t>(phase) * clip.phase_stride;
      pass_.kernels.composite(rows, of_phases, slab_mm, pass_.termination_threshold,
                              image_.rows(fine_row, static_cast<std::int64_t>(phase)));
    }
    if (pass_.shares != nullptr) shares_.add(rows, phases_, fine_row, numbers_.selected());
    for_each_row_with_fragments(rows, fine_row,
                                [&](std::int64_t row) { fragments_.behind_slab(row, accumulated(row)); });
  }

  [[nodiscard]] AccumulatedRow accumulated(std::int64_t fine_row) const {
    AccumulatedRow row = image_.accumulated(fine_row);
    if (pass_.shares != nullptr) row.shares = &shares_;
    return row;
  }

  /// Calls body(fine row) for rows that receive footprints, if there are any fragments.
  template <typename Body>
  void for_each_row_with_fragments(const SheetRows& rows, std::int64_t fine_row, const Body& body) {
    if (pass_.fragments.empty()) return;
    for (std::int64_t pair = 0; pair < rows.pairs; ++pair) {
      const std::int64_t upper = rows.upper + pair;
      if (rows.slice->row(upper).empty() && rows.slice->row(upper + 1).empty()) continue;
      for (std::size_t row = 0; row < rows.rows_between; ++row)
        body(fine_row + pair * scale_ + static_cast<std::int64_t>(row));
    }
  }

  /// Interleaves phases and planes into the finished sheet.
  void store() {
    SheetImage& sheet = pass_.image;
    std::vector<const float*> phase_rows;  // of every plane
    for (std::int64_t row = first_ * scale_; row < last_ * scale_; ++row) {
      phase_rows.clear();
      for (std::int64_t phase = 0; phase < scale_; ++phase) {
        for (std::int64_t plane = 0; plane < image_.planes(); ++plane)
          phase_rows.push_back(image_.row(row, phase) + plane * image_.plane_stride());
      }
      float* out = &sheet.pixels[static_cast<std::size_t>((row + 1) * sheet.stride() * sheet.channels)];
      std::fill_n(out, sheet.channels, 0.0f);
      interleave(phase_rows, pass_.window.columns, out + sheet.channels);
      std::fill_n(out + (sheet.stride() - 1) * sheet.channels, sheet.channels, 0.0f);
    }
  }

  const Pass& pass_;
  std::int64_t scale_, group_, first_, last_;
  BandImage image_;
  SheetFragments& fragments_;
  BandNumbers& numbers_;         // of the current slab, if shares are asked for
  BandShares& shares_;           // the same
  std::vector<Phase> phases_;    // of the current slice
  ClipSlabs::Rows kept_;         // of the current rows, with a cut
  std::vector<Blocks> visible_;  // of the current voxel rows, with a cut
};

/// Number of voxels of spans in rows [first, last) that a cut does not remove as a whole.
std::uint64_t count_kept(const ClipSlabs& kept, const SliceSpans& slice, std::int64_t first,
                         std::int64_t last) {
  std::uint64_t voxels = 0;
  for (std::int64_t row = std::max(first, slice.first_row); row < std::min(last, slice.last_row); ++row) {
    if (slice.row(row).empty()) continue;
    const auto [begin, end] = kept.visible_voxels(static_cast<double>(slice.number), row, 1);
    for (const Span& span : slice.row(row)) {
      const std::int64_t voxel = std::int64_t{span.first_block} * kBlock;
      if (voxel < end && voxel + std::int64_t{span.blocks} * kBlock > begin) voxels += span.voxels;
    }
  }
  return voxels;
}

/// Number of voxels in the rows that overlap the window.
std::uint64_t count_voxels(const Pass& pass) {
  std::uint64_t voxels = 0;
  for (const SliceSpans& slice : pass.model.slices) {
    if (slice.spans.empty()) continue;
    const SliceRows rows(pass.shear, pass.window, static_cast<double>(slice.number));
    // The footprint of a voxel row extends to its neighbours: include one row on either side.
    const std::int64_t first = rows.upper_from(pass.window.scale - 1, 0);
    const std::int64_t last = rows.upper_from(0, pass.window.fine_rows()) + 1;
    if (pass.kept != nullptr) {
      voxels += count_kept(*pass.kept, slice, first, last);
      continue;
    }
    if (first <= slice.first_row && last >= slice.last_row) {
      voxels += slice.voxels;
      continue;
    }
    for (std::int64_t row = std::max(first, slice.first_row); row < std::min(last, slice.last_row); ++row) {
      for (const Span& span : slice.row(row)) voxels += span.voxels;
    }
  }
  return voxels;
}

}  // namespace

std::uint64_t render_sheets(const SpanModel& model, const Shear& shear, const SheetWindow& window,
                            const SplatKernels& kernels, float termination_threshold,
                            std::span<const VoxelPlane> planes, FragmentOrder& fragments, SheetImage& image,
                            ThreadPool& pool, const SharePass* shares) {
  // Clear the border of the sheet
  image.window = window;
  image.channels = 1 + model.emissions;
  image.color = model.color;
  const auto row_floats = static_cast<std::size_t>(image.stride() * image.channels);
  image.pixels.resize(static_cast<std::size_t>(window.fine_rows() + 2) * row_floats);
  std::fill_n(image.pixels.begin(), row_floats, 0.0f);
  std::fill_n(image.pixels.end() - static_cast<std::ptrdiff_t>(row_floats), row_floats, 0.0f);

  // Split the window into bands
  const ClipSlabs kept(planes, shear, window, ImageRows::kMargin);
  const Pass pass{model,     shear, window, kernels, termination_threshold, planes.empty() ? nullptr : &kept,
                  fragments, image, shares};
  const std::int64_t row_bytes =
      BandImage::stride(window) * window.scale * window.scale * image.channels * std::int64_t{sizeof(float)};
  const std::int64_t band_rows =
      std::clamp<std::int64_t>(kBandBytes / std::max<std::int64_t>(row_bytes, 1), 1, kMaxBandRows);
  std::vector<SheetFragments> band_fragments;
  for (std::int64_t row = 0; row < window.rows; row += band_rows) {
    const std::int64_t last = std::min(row + band_rows, window.rows);
    band_fragments.emplace_back(fragments, row * window.scale, last * window.scale, window, model.color);
  }

  if (shares != nullptr) shares->shares.reset(window, band_rows);

  // Render bands in parallel
  pool.for_each(band_fragments.size(), [&](std::size_t n) {
    static thread_local BandMemory memory;
    const std::int64_t first = static_cast<std::int64_t>(n) * band_rows;
    Band(pass, first, std::min(first + band_rows, window.rows), band_fragments[n], memory).render();
    if (shares != nullptr) memory.shares.store(n, shares->shares);
  });
  for (SheetFragments& of_band : band_fragments) of_band.merge();
  if (shares != nullptr) shares->of_fragments = SheetFragments::merge_shares(band_fragments);
  return count_voxels(pass);
}

}  // namespace splatlas
