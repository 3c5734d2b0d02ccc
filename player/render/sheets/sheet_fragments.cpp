#include "player/render/sheets/sheet_fragments.h"

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

void SheetFragments::merge() {
  const std::size_t first = order_.row_begin(first_ - 1);
  for (std::size_t n = 0; n < deferred_.size(); ++n) {
    SlabRadiance& radiance = *order_.radiance(first + n);
    radiance.before += deferred_[n].before;
    radiance.behind += deferred_[n].behind;
  }
}

}  // namespace splatlas
