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

}  // namespace splatlas
