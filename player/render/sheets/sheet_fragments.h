// Transfer of accumulated volume radiance to the surface fragments between slabs.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "player/render/contributions/fragment_shares.h"
#include "player/render/sheets/band_image.h"
#include "player/render/sheets/fragment_order.h"

namespace splatlas {

/// Interpolates the accumulated radiance of a band of rows at the adjacent fragments. Rows change only while
/// a slab is composited, so that each fragment is visited only at its own slab.
class SheetFragments {
 public:
  /// Rows [first, last) of the window's sheet; `color` is that of a volume of one colour. Fragments just
  /// above the first row belong to the band above, too: contributions to them are deferred until merge().
  SheetFragments(FragmentOrder& order, std::int64_t first, std::int64_t last, const SheetWindow& window,
                 const std::array<float, 3>& color);

  /// To call before and after a slab is composited onto a row; slabs come front to back.
  void before_slab(std::int64_t fine_row, std::int32_t slab, const AccumulatedRow& row) {
    for (Cursor& cursor : cursors_[static_cast<std::size_t>(fine_row - first_)]) {
      if (cursor.next_slab <= slab) reach(cursor, slab, row);
    }
  }
  void behind_slab(std::int64_t fine_row, const AccumulatedRow& row) {
    for (Cursor& cursor : cursors_[static_cast<std::size_t>(fine_row - first_)]) {
      if (cursor.waiting < cursor.next) leave(cursor, row);
    }
  }
  /// After the last slab of a row.
  void finish(std::int64_t fine_row, const AccumulatedRow& row) {
    before_slab(fine_row, kBehindEverything, row);
  }

  /// Adds deferred contributions, once all bands are finished.
  void merge();

  /// Takes the shares of structures in front of the fragments of all bands.
  [[nodiscard]] static FragmentShares merge_shares(std::span<SheetFragments> bands);

 private:
  static constexpr std::int32_t kNoMore = std::numeric_limits<std::int32_t>::max();
  static constexpr std::int32_t kBehindEverything = kNoMore - 1;

  /// Cursor over the fragments on one side of a row.
  struct Cursor {
    std::int32_t next_slab = kNoMore;            ///< of `next`
    bool row_is_below = false;                   ///< true if the fragments are above the row
    std::size_t waiting = 0, next = 0, end = 0;  ///< entries; [waiting, next) are in the current slab
    std::size_t first = 0;                       ///< first entry
    SlabRadiance* radiance = nullptr;            ///< of the first entry
  };

  void set_next(Cursor& cursor, std::size_t next) const;
  void reach(Cursor& cursor, std::int32_t slab, const AccumulatedRow& row);
  void leave(Cursor& cursor, const AccumulatedRow& row);
  /// The row's contribution to the interpolated radiance in front of a fragment.
  [[nodiscard]] Radiance share(const FragmentOrder::Entry& entry, bool row_is_below,
                               const AccumulatedRow& row) const;
  /// Lists the row's contribution to the shares in front of entry `n`.
  void list_shares(std::size_t n, bool before, bool behind, bool row_is_below, const AccumulatedRow& row);

  FragmentOrder& order_;
  std::int64_t first_;
  std::int32_t scale_;
  std::array<float, 3> color_;
  std::vector<std::array<Cursor, 2>> cursors_;  // per row
  std::vector<SlabRadiance> deferred_;          // of the fragments above the first row
  std::vector<FragmentShare> shares_;           // empty unless asked for
};

}  // namespace splatlas
