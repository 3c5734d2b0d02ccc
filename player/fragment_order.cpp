#include "player/fragment_order.h"

#include <algorithm>
#include <cmath>

#include "player/sheets.h"

namespace splatlas {

FragmentOrder::FragmentOrder(FragmentList& list, const Shear& shear, const SheetWindow& window,
                             const PictureSize& size, const Grid& grid, ThreadPool& pool)
    : ascending_(shear.ascending), slices_(grid.size[shear.scan.slice_axis]) {
  const std::int64_t fine_rows = window.fine_rows();
  first_of_row_.assign(static_cast<std::size_t>(fine_rows) + 3, 0);
  list.above.assign(list.fragments.size(), Light{});
  list.below.assign(list.fragments.size(), Light{});
  if (window.empty()) return;

  // Where each fragment lies in the sheet.
  const Affine2& map = shear.picture_to_sheet;
  std::vector<Entry> entries(list.fragments.size());
  std::vector<std::int64_t> rows(list.fragments.size());
  pool.for_each(static_cast<std::size_t>(size.height), [&](std::size_t picture_row) {
    for (std::uint32_t n = list.first_of_row[picture_row]; n < list.first_of_row[picture_row + 1]; ++n) {
      const Fragment& fragment = list.fragments[n];
      const double x = static_cast<double>(fragment.pixel % static_cast<std::uint32_t>(size.width)) + 0.5;
      const double y = static_cast<double>(picture_row) + 0.5;
      const double sheet_x =
          (map.xx * x + map.xy * y + map.x0 - static_cast<double>(window.u0)) * window.scale;
      const double sheet_y =
          (map.yx * x + map.yy * y + map.y0 - static_cast<double>(window.v0)) * window.scale;
      const double column = std::clamp(std::floor(sheet_x), -2.0, static_cast<double>(window.fine_columns()));
      const double row = std::clamp(std::floor(sheet_y), -2.0, static_cast<double>(fine_rows));
      // A slab reaches from half a voxel in front of its slice to half a voxel behind it.
      const double along = ascending_ ? fragment.depth : fragment.depth + static_cast<double>(slices_ - 1);
      const double slab = std::clamp(std::floor(along + 0.5), 0.0, static_cast<double>(slices_ - 1));
      entries[n] = {n,
                    static_cast<std::int32_t>(slab),
                    static_cast<float>(std::clamp(along + 0.5 - slab, 0.0, 1.0)),
                    static_cast<std::int32_t>(column),
                    static_cast<float>(std::clamp(sheet_x - column, 0.0, 1.0)),
                    static_cast<float>(std::clamp(sheet_y - row, 0.0, 1.0))};
      rows[n] = static_cast<std::int64_t>(row);
    }
  });

  // Sort by row (counting), then by slab within a row.
  const auto inside = [&](std::int64_t row) { return row >= -1 && row < fine_rows; };
  for (const std::int64_t row : rows) {
    if (inside(row)) ++first_of_row_[static_cast<std::size_t>(row + 2)];
  }
  for (std::size_t n = 1; n < first_of_row_.size(); ++n) first_of_row_[n] += first_of_row_[n - 1];
  entries_.resize(first_of_row_.back());
  std::vector<std::size_t> next(first_of_row_.begin(), first_of_row_.end());
  for (std::size_t n = 0; n < entries.size(); ++n) {
    if (inside(rows[n])) entries_[next[static_cast<std::size_t>(rows[n] + 1)]++] = entries[n];
  }
  pool.for_each(static_cast<std::size_t>(fine_rows) + 1, [&](std::size_t n) {
    std::sort(entries_.begin() + static_cast<std::ptrdiff_t>(first_of_row_[n]),
              entries_.begin() + static_cast<std::ptrdiff_t>(first_of_row_[n + 1]),
              [](const Entry& a, const Entry& b) {
                return a.slab != b.slab ? a.slab < b.slab : a.fragment < b.fragment;
              });
  });
}

}  // namespace splatlas
