// Clip policies of the bands of a sheet.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "player/render/clip/clip_rows.h"
#include "player/render/clip/clip_slabs.h"
#include "player/render/sheets/spans/span_model.h"
#include "player/render/sheets/splat/block_runs.h"

namespace splatlas {

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

  /// Blocks of voxel rows [first, last) that the slab shows; empty: all.
  [[nodiscard]] std::span<const Blocks> visible(double k, std::int64_t first, std::int64_t last) {
    visible_.clear();
    for (std::int64_t row = first; row < last; ++row) {
      const auto [first_voxel, last_voxel] = slabs_.visible_voxels(k, row);
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

}  // namespace splatlas
