// Transfer of accumulated volume radiance to the surface fragments between slabs.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

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

  [[nodiscard]] bool empty() const { return order_.empty(); }
  /// To call before and after a slab is composited onto a row; slabs come front to back.
  void before_slab(std::int64_t fine_row, std::int32_t slab, const AccumulatedRow& row) {
    for (Cursor& cursor : cursors_[static_cast<std::size_t>(fine_row - first_)]) {
      if (cursor.next_slab <= slab) reach(cursor, slab, row);
    }
  }
  void behind_slab(std::int64_t fine_row, const AccumulatedRow& row) {
    for (Cursor& cursor : cursors_[static_cast<std::size_t>(fine_row - first_)]) {
      for (; cursor.waiting < cursor.next; ++cursor.waiting) add(cursor, cursor.waiting, false, true, row);
    }
  }
  /// After the last slab of a row.
  void finish(std::int64_t fine_row, const AccumulatedRow& row) {
    before_slab(fine_row, kBehindEverything, row);
  }

  /// Adds deferred contributions, once all bands are finished.
  void merge();

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

  /// Fragments in front of `slab` get the current radiance for both ends of their slab. Fragments within it
  /// get it for the front, and wait for the end of the slab.
  void reach(Cursor& cursor, std::int32_t slab, const AccumulatedRow& row) {
    std::size_t n = cursor.next;
    for (; n < cursor.end && order_.entry(n).slab < slab; ++n) add(cursor, n, true, true, row);
    cursor.waiting = n;
    for (; n < cursor.end && order_.entry(n).slab == slab; ++n) add(cursor, n, true, false, row);
    set_next(cursor, n);
  }

  /// Adds the row's contribution to what is in front of entry n, and of the end of its slab.
  void add(const Cursor& cursor, std::size_t n, bool before, bool behind, const AccumulatedRow& row) {
    const FragmentOrder::SheetPlace& place = order_.place_of_sample(order_.entry(n).sample);
    SlabRadiance& radiance = cursor.radiance[n - cursor.first];
    const Radiance share = this->share(place, cursor.row_is_below, row);
    if (before) radiance.before += share;
    if (behind) radiance.behind += share;
  }
  /// The row's contribution to the interpolated radiance in front of a fragment.
  [[nodiscard]] Radiance share(const FragmentOrder::SheetPlace& place, bool row_is_below,
                               const AccumulatedRow& row) const {
    const float left = place.weights[row_is_below ? 2 : 0];
    const float right = place.weights[row_is_below ? 3 : 1];
    const float* left_pixel = row.first + place.phase * row.phase_stride + place.column;
    const float* right_pixel =
        place.phase + 1 < scale_ ? left_pixel + row.phase_stride : row.first + place.column + 1;
    const auto at = [&](std::int64_t plane) {
      return left * left_pixel[plane * row.plane_stride] + right * right_pixel[plane * row.plane_stride];
    };
    return row.planes == 4 ? Radiance{{at(0), at(1), at(2), at(3)}} : in_color(at(0), at(1), color_);
  }

  FragmentOrder& order_;
  std::int64_t first_;
  std::int32_t scale_;
  std::array<float, 3> color_;
  std::vector<std::array<Cursor, 2>> cursors_;  // per row
  std::vector<SlabRadiance> deferred_;          // of the fragments above the first row
};

}  // namespace splatlas
