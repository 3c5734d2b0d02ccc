#include "player/render/sheets/lit_slices.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace splatlas {

void LitSlices::light(const SliceSpans& slice, double reach, const RowRange& rows,
                      std::span<const Blocks> visible, std::size_t place) {
  static thread_local std::array<SliceSpans, 2> lit;  // reuses memory
  ShownRows& shown = shown_[place];
  shown.slice = &slice;
  shown.hidden.clear();
  if (slice.lights.empty() || factors_.empty()) return;
  shown.slice = &lit[place];
  shown.rows = rows;
  find_hidden(static_cast<double>(slice.number), reach, shown);
  light_rows(slice, rows, visible, shown.hidden, factors_, lit[place]);
}

/// Finds the blocks of the rows whose pixels are known to be opaque but for the last one, which supplies
/// the carry of the next.
void LitSlices::find_hidden(double k, double reach, ShownRows& shown) {
  constexpr Blocks kAll{std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::max()};
  const std::int64_t scale = window_.scale;
  const SliceRows first(shear_, window_, k - reach), last(shear_, window_, k + reach);

  // Blocks of each fine row that are opaque in all phases, at every shift
  const auto [low, high] = std::minmax({shear_.u_shift(k - reach), shear_.u_shift(k + reach)});
  const auto max_shift = static_cast<std::int64_t>(std::floor(high)) - window_.u0;
  const double last_phase = static_cast<double>(scale - 1) / static_cast<double>(scale);
  const auto min_shift = static_cast<std::int64_t>(std::floor(low - last_phase)) - window_.u0;
  opaque_.clear();
  bool any = false;
  for (std::int64_t row = band_.first_fine_row(); row < band_.last_fine_row(); ++row) {
    Blocks& of_row = opaque_.emplace_back(kAll);
    for (std::int64_t phase = 0; phase < scale && of_row.first < of_row.last; ++phase) {
      const OpaquePixels& opaque = band_.opaque(row, phase);
      of_row.first = std::max(of_row.first, (opaque.first - min_shift + kBlock - 1) >> kBlockBits);
      of_row.last = std::min(of_row.last, (opaque.last - max_shift) >> kBlockBits);
    }
    any = any || of_row.first < of_row.last;
  }
  if (!any) return;

  // Blocks of each voxel row that are opaque in all fine rows
  for (std::int64_t row = shown.rows.first; row < shown.rows.last; ++row) {
    const std::int64_t from = std::min(first.fine_row(row - 1, 0), last.fine_row(row - 1, 0));
    const std::int64_t to = std::max(first.fine_row(row + 1, 0), last.fine_row(row + 1, 0));
    Blocks hidden = kAll;
    for (std::int64_t n = std::max(from, band_.first_fine_row()); n < std::min(to, band_.last_fine_row());
         ++n) {
      const Blocks& opaque = opaque_[static_cast<std::size_t>(n - band_.first_fine_row())];
      hidden = {std::max(hidden.first, opaque.first), std::min(hidden.last, opaque.last)};
    }
    shown.hidden.push_back({hidden.first, hidden.last - 1});
  }
}

}  // namespace splatlas
