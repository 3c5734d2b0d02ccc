// Rendering of a band of rows of the sheet.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "format/tasks/task_control.h"
#include "player/render/sheets/band_image.h"
#include "player/render/sheets/slabs.h"
#include "player/render/sheets/splat/slice_mix.h"
#include "player/render/view/sheet_window.h"

namespace splatlas {

/// Arguments of render_sheets() for all bands. References must outlive it.
struct SheetPass {
  const SpanModel& model;
  const Shear& shear;
  const SheetWindow& window;
  const SplatKernels& kernels;
  float termination_threshold;
  const Slabs& slabs;
};

/// Rendering of the rows of `image` through all slices, front to back. `Clip`: a policy of band_clip.h.
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
        clip_(clip) {}

  void render() {
    std::int64_t next = -1;  // first interval that is not rendered yet
    const std::vector<SliceSpans>& slices = pass_.model.slices;
    for (std::size_t place = 0; place < slices.size(); ++place) {
      const SliceSpans& slice = slices[pass_.shear.ascending ? place : slices.size() - 1 - place];
      if (slice.spans.empty()) continue;
      check_task();
      if (pass_.window.parts == 1) {  // slabs around slices
        const auto k = static_cast<double>(slice.number);
        if (!removes(k)) render_slab({slice, k, {pass_.shear, pass_.window, k}});
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
    SlicePair pair{slice(n), slice(n + 1), 0};
    if (pair.before == nullptr && pair.behind == nullptr) return;
    for (int part = 0; part < pass_.window.parts; ++part) {
      const double middle = (part + 0.5) / pass_.window.parts;
      const double k =
          static_cast<double>(pass_.model.slice_first) + from_viewer(static_cast<double>(n) + middle);
      pair.behind_weight = static_cast<float>(middle);
      if (removes(k)) continue;
      const SliceRows rows(pass_.shear, pass_.window, k);
      const std::int64_t first = rows.upper_from(scale_ - 1, image_.first_fine_row());
      const std::int64_t last = rows.upper_from(0, image_.last_fine_row()) + 1;
      mix_slices(pair, first, last, clip_.visible(k, first, last), pass_.kernels, mixed);
      if (!mixed.spans.empty()) render_slab({mixed, k, rows});
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
};

}  // namespace splatlas
