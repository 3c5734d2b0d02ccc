#include "player/render/sheets/sheets.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "format/tasks/task_control.h"
#include "player/render/sheets/lit_slices.h"
#include "player/render/sheets/splat/block_runs.h"

namespace splatlas {
namespace {

/// Arguments of render_sheets() for all bands. References must outlive it.
struct SheetPass {
  const SpanModel& model;
  const Shear& shear;
  const SheetWindow& window;
  const SplatKernels& kernels;
  float termination_threshold;
  const Slabs& slabs;
  std::span<const float> factors;  // of SheetSpans
};

/// Rendering of the rows of `image` through all slices, front to back. `Clip`: NoClip or BandClip.
/// `Surfaces`: what is between the slabs, BandFragments or BandEnds.
template <class Clip, class Surfaces>
class Band {
 public:
  /// All references must outlive it.
  Band(const SheetPass& pass, const Clip& clip, BandImage& image, Surfaces& surfaces)
      : pass_(pass),
        scale_(pass.window.scale),
        group_(static_cast<std::int64_t>(SheetRows::group_size(pass.window.scale))),
        image_(image),
        surfaces_(surfaces),
        clip_(clip),
        slices_(pass.shear, pass.window, pass.factors, image) {}

  void render() {
    std::int64_t next = -1;  // first interval that is not rendered yet
    const std::vector<SliceSpans>& slices = pass_.model.slices;
    for (std::size_t place = 0; place < slices.size(); ++place) {
      const SliceSpans& slice = slices[pass_.shear.ascending ? place : slices.size() - 1 - place];
      if (slice.spans.empty()) continue;
      check_task();
      if (pass_.window.parts == 1) {  // slabs around slices
        const auto k = static_cast<double>(slice.number);
        if (!removes(k))
          render_slab({*slices_.rows(&slice, 0, 0, clip_)->slice, k, {pass_.shear, pass_.window, k}});
        continue;
      }
      const std::int64_t n = from_viewer(slice.number - pass_.model.slice_first);
      for (next = std::max(next, n - 1); next <= n; ++next) render_between(next);
    }
    surfaces_.finish();
  }

 private:
  /// A slab at position `k` along the principal axis.
  struct Slab {
    const SliceSpans& slice;
    double k;
    SliceRows rows;
  };

  /// Maps the n-th slice of the model to its rank from the viewer, 0 for the nearest, and back.
  [[nodiscard]] auto from_viewer(auto n) const {
    return pass_.shear.ascending ? n : static_cast<decltype(n)>(pass_.model.slice_count) - 1 - n;
  }
  /// The model's n-th slice from the viewer; null if it is empty or outside the model.
  [[nodiscard]] const SliceSpans* slice(std::int64_t n) const {
    return pass_.model.slice(pass_.model.slice_first + from_viewer(n));
  }
  /// True if the clip removes the whole slab.
  [[nodiscard]] bool removes(double k) const {
    return clip_.removes(k, image_.first_fine_row(), image_.last_fine_row());
  }

  /// Renders the interpolated slabs between slice n and the next one.
  void render_between(std::int64_t n) {
    static thread_local SliceSpans mixed;
    const double reach = 1 - 0.5 / pass_.window.parts;
    SlicePair pair;
    for (int part = 0; part < pass_.window.parts; ++part) {
      const double middle = (part + 0.5) / pass_.window.parts;
      const double k =
          static_cast<double>(pass_.model.slice_first) + from_viewer(static_cast<double>(n) + middle);
      pair.behind_weight = static_cast<float>(middle);
      if (removes(k)) continue;
      pair.before = slices_.rows(slice(n), reach, n, clip_);
      pair.behind = slices_.rows(slice(n + 1), reach, n + 1, clip_);
      if (pair.before == nullptr && pair.behind == nullptr) return;
      const SliceRows slab(pass_.shear, pass_.window, k);
      const RowRange rows = rows_of_band(slab, scale_, image_);
      mix_slices(pair, rows, clip_.visible(k, rows.first, rows.last), pass_.kernels, mixed);
      if (!mixed.spans.empty()) render_slab({mixed, k, slab});
    }
  }

  /// Splats and composites a slab.
  void render_slab(const Slab& slab) {
    // Find the sub-pixel offset of each phase
    const double u_shift = pass_.shear.u_shift(slab.k) - static_cast<double>(pass_.window.u0);
    phases_.clear();
    for (std::int64_t phase = 0; phase < scale_; ++phase) {
      const double shift = u_shift - static_cast<double>(phase) / static_cast<double>(scale_);
      const double whole = std::floor(shift);
      phases_.push_back({static_cast<float>(shift - whole), static_cast<std::int64_t>(whole)});
    }

    // Render the fine rows in groups
    surfaces_.before_slab(pass_.slabs.slab_of(slab.k));
    for (std::int64_t between = 0; between < scale_; between += group_)
      render_rows(slab, between, std::min(group_, scale_ - between));
    surfaces_.behind_slab();
  }

  /// Renders fine rows [between, between + count) of every pair of voxel rows. Rows at the border of the band
  /// may lack the others of their group.
  void render_rows(const Slab& slab, std::int64_t between, std::int64_t count) {
    // Find the pairs whose fine rows are all within the band
    const auto upper_rows = [&](std::int64_t row) {
      return std::pair(std::max(slab.slice.first_row - 1, slab.rows.upper_from(row, image_.first_fine_row())),
                       std::min(slab.slice.last_row, slab.rows.upper_from(row, image_.last_fine_row())));
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
      composite(slab, row, 1, own_first, std::min(first, own_last));
      composite(slab, row, 1, std::max({first, last, own_first}), own_last);
    }
    composite(slab, between, count, first, last);
  }

  /// Composites `count` fine rows of the pairs with upper voxel rows [first, last).
  void composite(const Slab& slab, std::int64_t between, std::int64_t count, std::int64_t first,
                 std::int64_t last) {
    if (first >= last) return;
    SheetRows rows;
    rows.slice = &slab.slice;
    rows.rows_between = static_cast<std::size_t>(count);
    for (std::int64_t row = 0; row < count; ++row)
      rows.lower_weights[static_cast<std::size_t>(row)] = slab.rows.lower_weight(between + row);
    clip_.for_each_part(slab.k, slab.rows.fine_row(first, between), last - first, count,
                        [&](std::int64_t first_pair, std::int64_t last_pair, const ClipRows& clip) {
                          rows.upper = first + first_pair;
                          rows.pairs = last_pair - first_pair;
                          composite(rows, slab.rows.fine_row(rows.upper, between), clip);
                        });
  }

  /// Composites rows in all phases. `fine_row` is the first one of the first pair.
  void composite(SheetRows& rows, std::int64_t fine_row, const ClipRows& clip) {
    const auto slab_mm = static_cast<float>(pass_.shear.slab_mm / pass_.window.parts);
    for (std::size_t phase = 0; phase < phases_.size(); phase += rows.phase_count) {
      rows.phase_count = std::min<std::size_t>(group_, phases_.size() - phase);
      std::copy_n(phases_.begin() + static_cast<std::ptrdiff_t>(phase), rows.phase_count,
                  rows.phases.begin());
      ClipRows of_phases = clip;
      of_phases.lines += static_cast<std::int64_t>(phase) * clip.phase_stride;
      pass_.kernels.composite(rows, of_phases, slab_mm, pass_.termination_threshold,
                              image_.rows(fine_row, static_cast<std::int64_t>(phase)));
    }
  }

  const SheetPass& pass_;
  std::int64_t scale_, group_;
  BandImage& image_;
  Surfaces& surfaces_;
  Clip clip_;
  std::vector<Phase> phases_;  // of the current slab
  LitSlices slices_;
};

/// Clip policy of a band without a cut; members as in BandClip.
struct NoClip {
  [[nodiscard]] bool removes(auto...) const { return false; }
  [[nodiscard]] std::span<const Blocks> visible(auto...) const { return {}; }
  void for_each_part(double /*k*/, std::int64_t /*fine_row*/, std::int64_t pairs, std::int64_t /*count*/,
                     const auto& body) const {
    body(std::int64_t{0}, pairs, ClipRows{});
  }
  [[nodiscard]] bool keeps_slices() const { return true; }
  [[nodiscard]] std::pair<std::int64_t, std::int64_t> visible_voxels(const auto&...) const {
    return {std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::max()};
  }
};

/// Clip policy of a band of a cut sheet.
class BandClip {
 public:
  /// For a sheet with `scale` pixels per voxel. `slabs` must outlive it.
  BandClip(const ClipSlabs& slabs, std::int64_t scale) : slabs_(slabs), scale_(scale) {}

  /// True if nothing of the slab centred at `k` is kept in fine rows [first, last).
  [[nodiscard]] bool removes(double k, std::int64_t first, std::int64_t last) const {
    return slabs_.state(k, first, last) == ClipSlabs::State::kRemoved;
  }

  /// Blocks of voxel rows [first, last) that slabs up to `reach` slices away show; empty: all.
  [[nodiscard]] std::span<const Blocks> visible(double k, std::int64_t first, std::int64_t last,
                                                double reach = 0) {
    visible_.clear();
    for (std::int64_t row = first; row < last; ++row) {
      const auto [first_voxel, last_voxel] = slabs_.visible_voxels(k, row, reach);
      visible_.push_back({first_voxel >> kBlockBits, (last_voxel + kBlock - 1) >> kBlockBits});
    }
    return visible_;
  }

  /// Calls body(first pair, last pair, clip) for the pairs of voxel rows that the slab shows. `fine_row` is
  /// the first of the first pair, which has `count` of them.
  void for_each_part(double k, std::int64_t fine_row, std::int64_t pairs, std::int64_t count,
                     const auto& body) {
    using enum ClipSlabs::State;
    const ClipSlabs::State of_all = slabs_.state(k, fine_row, fine_row + pairs * scale_);
    if (of_all == kWhole) body(std::int64_t{0}, pairs, ClipRows{});
    if (of_all != kCut) return;
    // Split the pairs by removed, cut and whole rows
    rows_.fill(slabs_, k, fine_row, pairs, count);
    for (std::int64_t first = 0, last = 0; first < pairs; first = last) {
      const ClipSlabs::State state = rows_.state(first);
      while (last < pairs && rows_.state(last) == state) ++last;
      if (state != kRemoved) body(first, last, state == kCut ? rows_.from(first, 0) : ClipRows{});
    }
  }

  /// True if nothing is removed of any slice.
  [[nodiscard]] bool keeps_slices() const { return false; }
  /// Voxels [first, last) of a row of a slice that reach visible pixels.
  [[nodiscard]] std::pair<std::int64_t, std::int64_t> visible_voxels(const SliceSpans& slice,
                                                                     std::int64_t row) const {
    return slabs_.visible_voxels(static_cast<double>(slice.number), row, 1);
  }

 private:
  const ClipSlabs& slabs_;
  std::int64_t scale_;
  ClipSlabs::Rows rows_;         // of the current pairs
  std::vector<Blocks> visible_;  // of the current voxel rows
};

/// Rows of a band in voxels: few enough for load balance and, with fragments, for their samples in cache.
constexpr std::int64_t kMaxBandRows = 16, kMaxRowsWithFragments = 8;
/// Maximum size of a band's accumulation buffer, which should fit the L2 cache.
constexpr std::int64_t kBandBytes = std::int64_t{1} << 18;

/// Makes a transparent sheet, with its border.
void begin_sheet(const SheetPass& pass, SheetImage& sheet) {
  sheet.window = pass.window;
  sheet.channels = 1 + pass.model.emissions;
  sheet.color = pass.model.color;
  const auto row_floats = static_cast<std::size_t>(sheet.stride() * sheet.channels);
  sheet.pixels.resize(static_cast<std::size_t>(pass.window.fine_rows() + 2) * row_floats);
  std::fill_n(sheet.pixels.begin(), row_floats, 0.0f);
  std::fill_n(sheet.pixels.end() - static_cast<std::ptrdiff_t>(row_floats), row_floats, 0.0f);
}

/// Number of voxels, in the rows that overlap fine rows [first_row, last_row) of the window, of spans that
/// are not removed as a whole.
template <class Clip>
std::uint64_t count_voxels(const SheetPass& pass, const Clip& clip, std::int64_t first_row,
                           std::int64_t last_row) {
  std::uint64_t voxels = 0;
  for (const SliceSpans& slice : pass.model.slices) {
    if (slice.spans.empty()) continue;
    const SliceRows rows(pass.shear, pass.window, static_cast<double>(slice.number));
    // The footprint of a voxel row extends to its neighbours: include one row on either side.
    const std::int64_t first = rows.upper_from(pass.window.scale - 1, first_row);
    const std::int64_t last = rows.upper_from(0, last_row) + 1;
    if (clip.keeps_slices() && first <= slice.first_row && last >= slice.last_row) {
      voxels += slice.voxels;
      continue;
    }
    for (std::int64_t row = std::max(first, slice.first_row); row < std::min(last, slice.last_row); ++row) {
      const auto [begin, end] = clip.visible_voxels(slice, row);
      for (const Span& span : slice.row(row)) {
        const std::int64_t voxel = std::int64_t{span.first_block} * kBlock;
        if (voxel < end && voxel + std::int64_t{span.blocks} * kBlock > begin) voxels += span.voxels;
      }
    }
  }
  return voxels;
}

/// out[n * rows + r] = from[r][n]. `kRows`: their number, to unroll the loop, or 0.
template <std::size_t kRows>
void interleave(const std::vector<const float*>& from, std::int64_t count, float* out) {
  const std::size_t rows = kRows == 0 ? from.size() : kRows;
  for (std::int64_t n = 0; n < count; ++n) {
    for (std::size_t r = 0; r < rows; ++r) out[static_cast<std::size_t>(n) * rows + r] = from[r][n];
  }
}

/// Interleaves phases and planes into the rows of the finished sheet, up to fine row `last`.
void store(const BandImage& image, std::int64_t last, SheetImage& sheet) {
  std::vector<const float*> phase_rows;  // of every plane
  for (std::int64_t fine_row = image.first_fine_row(); fine_row < last; ++fine_row) {
    phase_rows.clear();
    for (std::int64_t phase = 0; phase < sheet.window.scale; ++phase) {
      for (std::int64_t plane = 0; plane < image.planes(); ++plane)
        phase_rows.push_back(image.row(fine_row, phase) + plane * image.plane_stride());
    }
    float* out = &sheet.pixels[static_cast<std::size_t>((fine_row + 1) * sheet.stride() * sheet.channels)];
    std::fill_n(out, sheet.channels, 0.0f);
    float* const pixels = out + sheet.channels;
    switch (phase_rows.size()) {
      case 2: interleave<2>(phase_rows, sheet.window.columns, pixels); break;
      case 4: interleave<4>(phase_rows, sheet.window.columns, pixels); break;
      case 8: interleave<8>(phase_rows, sheet.window.columns, pixels); break;
      default: interleave<0>(phase_rows, sheet.window.columns, pixels);
    }
    std::fill_n(out + (sheet.stride() - 1) * sheet.channels, sheet.channels, 0.0f);
  }
}

/// Renders the bands in parallel. Returns the number of splatted voxels.
template <class Clip>
std::uint64_t render_bands(const SheetPass& pass, const SheetSpans& spans, const Clip& clip,
                           const SheetSurfaces& surfaces, SheetImage& sheet, ThreadPool& pool) {
  // Split the window into bands
  const SheetWindow& window = pass.window;
  const std::int64_t row_bytes =
      BandImage::stride(window) * window.scale * window.scale * sheet.channels * std::int64_t{sizeof(float)};
  const std::int64_t band_rows =
      std::clamp<std::int64_t>(kBandBytes / std::max<std::int64_t>(row_bytes, 1), 1,
                               surfaces.list.fragments.empty() ? kMaxBandRows : kMaxRowsWithFragments);
  const auto fine_row = [&](std::size_t band) {
    return std::min(static_cast<std::int64_t>(band) * band_rows, window.rows) * window.scale;
  };
  surfaces.fragments.build(surfaces.list, surfaces.cuts, surfaces.size, pass.shear, window, pass.slabs,
                           sheet.channels, band_rows * window.scale, pool);

  const auto render_band = [&](const SheetPass& strip, std::size_t n) {
    // Reuse memory: page faults would cost more than the band
    static thread_local std::vector<float> floats;
    static thread_local BandFragments fragments;
    // Fragments behind the last row are in front of the next one, too
    const std::int64_t last = fine_row(n + 1);
    BandImage image(window, strip.model.emissions, fine_row(n), surfaces.fragments.empty() ? last : last + 1,
                    floats);
    if (surfaces.ends != nullptr) {
      BandEnds ends(*surfaces.ends, image);
      Band(strip, clip, image, ends).render();
      ends.restore();
    } else {
      fragments.begin(surfaces.fragments, n, pass.slabs, image, pass.model.color);
      Band(strip, clip, image, fragments).render();
    }
    store(image, last, sheet);
  };
  std::uint64_t voxels = 0;
  spans.for_each_strip(
      pass.shear, window.v0, static_cast<std::size_t>((window.rows + band_rows - 1) / band_rows), band_rows,
      [&](const SpanModel& model, std::size_t first, std::size_t last) {
        SheetPass strip{model,      pass.shear,     window, pass.kernels, pass.termination_threshold,
                        pass.slabs, spans.factors()};
        pool.for_each(last - first, [&](std::size_t n) { render_band(strip, first + n); });
        voxels += count_voxels(strip, clip, fine_row(first), fine_row(last));
      });
  return voxels;
}

}  // namespace

std::uint64_t render_sheets(const SheetSpans& spans, const Shear& shear, const SheetWindow& window,
                            const SplatKernels& kernels, float termination_threshold,
                            std::span<const VoxelPlane> planes, const Slabs& slabs,
                            const SheetSurfaces& surfaces, SheetImage& image, ThreadPool& pool) {
  const SheetPass pass{spans.frame(), shear, window, kernels, termination_threshold, slabs, {}};
  begin_sheet(pass, image);
  if (planes.empty()) return render_bands(pass, spans, NoClip(), surfaces, image, pool);
  const ClipSlabs clip(planes, shear, window, ImageRows::kMargin);
  return render_bands(pass, spans, BandClip(clip, window.scale), surfaces, image, pool);
}

}  // namespace splatlas
