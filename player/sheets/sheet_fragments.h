// Between the slices: what the fragments near the rows of a sheet see of the volume in front of them.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "player/sheets/fragment_order.h"

namespace splatlas {

struct SheetWindow;

/// Where the accumulated light of a row of sheet pixels stands: red, green, blue (or white alone) and opacity
/// in planes, the pixels of each phase together. Pixels one before and one behind the row can be read.
struct AccumulatedRow {
  const float* first = nullptr;  ///< pixel 0 of phase 0, first plane
  std::int64_t planes = 4;       ///< 4 or 2
  std::int64_t plane_stride = 0, phase_stride = 0;
};

/// Hands a band of rows' share of the volume to the fragments next to them. Between two slabs a row changes
/// for nobody, so a fragment is visited only at its own slab.
class SheetFragments {
 public:
  /// Rows [first, last) of the window's sheet; `color` is what white stands for. The fragments just above the
  /// first row belong to the band above, too: what this one has to add to them is kept apart until merge().
  SheetFragments(FragmentOrder& order, std::int64_t first, std::int64_t last, const SheetWindow& window,
                 const std::array<float, 3>& color);

  /// Around the compositing of a slab onto a row; slabs come front to back.
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

  /// Adds what was kept apart; once all bands are done.
  void merge();

 private:
  static constexpr std::int32_t kNoMore = std::numeric_limits<std::int32_t>::max();
  static constexpr std::int32_t kBehindEverything = kNoMore - 1;

  /// The fragments on one side of a row.
  struct Cursor {
    std::int32_t next_slab = kNoMore;            ///< of `next`
    bool row_is_below = false;                   ///< the fragments
    std::size_t waiting = 0, next = 0, end = 0;  ///< entries; from `waiting` on their slab is not left yet
    std::size_t first = 0;                       ///< entry
    SlabRadiance* lights = nullptr;              ///< of the first entry
  };

  void set_next(Cursor& cursor, std::size_t next) const;
  void reach(Cursor& cursor, std::int32_t slab, const AccumulatedRow& row);
  void leave(Cursor& cursor, const AccumulatedRow& row);
  /// The row's share of what a fragment sees of the volume that has been composited.
  [[nodiscard]] Light share(const FragmentOrder::Entry& entry, bool row_is_below,
                            const AccumulatedRow& row) const;

  FragmentOrder& order_;
  std::int64_t first_;
  std::int32_t scale_;
  std::array<float, 3> color_;
  std::vector<std::array<Cursor, 2>> cursors_;  // per row
  std::vector<SlabRadiance> apart_;             // of the fragments above the first row
};

}  // namespace splatlas
