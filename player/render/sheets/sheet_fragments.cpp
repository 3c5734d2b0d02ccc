#include "player/render/sheets/sheet_fragments.h"

#include <utility>

#include "player/render/sheets/ids/sheet_shares.h"

namespace splatlas {

SheetFragments::SheetFragments(FragmentOrder& order, std::int64_t first, std::int64_t last,
                               const SheetWindow& window, const std::array<float, 3>& color)
    : order_(order),
      first_(first),
      scale_(window.scale),
      color_(color),
      cursors_(static_cast<std::size_t>(last - first)),
      deferred_(order.row_end(first - 1) - order.row_begin(first - 1)) {
  for (std::int64_t row = first; row < last; ++row) {
    auto& cursors = cursors_[static_cast<std::size_t>(row - first)];
    for (const bool below : {false, true}) {
      Cursor& cursor = cursors[below ? 1 : 0];
      const std::int64_t fragments_row = below ? row - 1 : row;
      cursor.row_is_below = below;
      cursor.waiting = order.row_begin(fragments_row);
      cursor.end = order.row_end(fragments_row);
      const bool deferred = below && row == first;
      cursor.radiance = deferred ? deferred_.data() : order.radiance(cursor.waiting);
      cursor.first = cursor.waiting;
      set_next(cursor, cursor.waiting);
    }
  }
}

void SheetFragments::set_next(Cursor& cursor, std::size_t next) const {
  cursor.next = next;
  cursor.next_slab = next < cursor.end ? order_.entry(next).slab : kNoMore;
}

/// Fragments in front of `slab` get the current radiance for both ends of their slab. Fragments within it get
/// it for the front, and wait for the end of the slab.
void SheetFragments::reach(Cursor& cursor, std::int32_t slab, const AccumulatedRow& row) {
  std::size_t n = cursor.next;
  for (; n < cursor.end && order_.entry(n).slab < slab; ++n) {
    SlabRadiance& radiance = cursor.radiance[n - cursor.first];
    const Radiance share = this->share(order_.entry(n), cursor.row_is_below, row);
    radiance.before += share;
    radiance.behind += share;
    if (row.shares != nullptr) list_shares(n, true, true, cursor.row_is_below, row);
  }
  cursor.waiting = n;
  for (; n < cursor.end && order_.entry(n).slab == slab; ++n) {
    cursor.radiance[n - cursor.first].before += share(order_.entry(n), cursor.row_is_below, row);
    if (row.shares != nullptr) list_shares(n, true, false, cursor.row_is_below, row);
  }
  set_next(cursor, n);
}

void SheetFragments::leave(Cursor& cursor, const AccumulatedRow& row) {
  for (; cursor.waiting < cursor.next; ++cursor.waiting) {
    cursor.radiance[cursor.waiting - cursor.first].behind +=
        share(order_.entry(cursor.waiting), cursor.row_is_below, row);
    if (row.shares != nullptr) list_shares(cursor.waiting, false, true, cursor.row_is_below, row);
  }
}

void SheetFragments::list_shares(std::size_t n, bool before, bool behind, bool row_is_below,
                                 const AccumulatedRow& row) {
  const FragmentOrder::Entry& entry = order_.entry(n);
  const auto list = [&](float weight, std::int64_t phase, std::int64_t column) {
    if (weight == 0) return;
    row.shares->for_each(row.fine_row, phase, column, [&](StructureNumber number, float share) {
      if (share > 0)
        shares_.push_back({static_cast<std::uint32_t>(n), number, before, behind, weight * share});
    });
  };
  list(entry.weights[row_is_below ? 2 : 0], entry.phase, entry.column);
  const bool same_column = entry.phase + 1 < scale_;
  list(entry.weights[row_is_below ? 3 : 1], same_column ? entry.phase + 1 : 0,
       same_column ? entry.column : entry.column + 1);
}

Radiance SheetFragments::share(const FragmentOrder::Entry& entry, bool row_is_below,
                               const AccumulatedRow& row) const {
  const float left = entry.weights[row_is_below ? 2 : 0];
  const float right = entry.weights[row_is_below ? 3 : 1];
  const float* left_pixel = row.first + entry.phase * row.phase_stride + entry.column;
  const float* right_pixel =
      entry.phase + 1 < scale_ ? left_pixel + row.phase_stride : row.first + entry.column + 1;
  Radiance radiance;
  for (std::int64_t c = 0; c < row.planes; ++c) {
    const std::int64_t plane = c * row.plane_stride;
    radiance.rgba[static_cast<std::size_t>(c)] = left * left_pixel[plane] + right * right_pixel[plane];
  }
  return row.planes == 4 ? radiance : in_color(radiance.rgba[0], radiance.rgba[1], color_);
}

void SheetFragments::merge() {
  const std::size_t first = order_.row_begin(first_ - 1);
  for (std::size_t n = 0; n < deferred_.size(); ++n) {
    SlabRadiance& radiance = *order_.radiance(first + n);
    radiance.before += deferred_[n].before;
    radiance.behind += deferred_[n].behind;
  }
}

FragmentShares SheetFragments::merge_shares(std::span<SheetFragments> bands) {
  std::vector<std::vector<FragmentShare>> of_bands;
  for (SheetFragments& band : bands) of_bands.push_back(std::move(band.shares_));
  FragmentShares merged;
  if (!bands.empty()) merged.build(bands[0].order_.entries(), of_bands);
  return merged;
}

}  // namespace splatlas
