// Rows of slices for a band of a sheet, lit.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "player/render/sheets/sheet_fragments.h"
#include "player/render/sheets/slabs.h"
#include "player/render/sheets/spans/span_model.h"
#include "player/render/view/shear.h"

namespace splatlas {

/// Voxel rows whose footprints reach a band, in a slab.
[[nodiscard]] inline RowRange rows_of_band(const SliceRows& slab, std::int64_t scale, const BandImage& band) {
  return {slab.upper_from(scale - 1, band.first_fine_row()), slab.upper_from(0, band.last_fine_row()) + 1};
}

/// Lights the slices of a band while it is rendered: where their pixels are not opaque yet. Not thread-safe.
class LitSlices {
 public:
  /// `factors`: of SheetSpans. All references must outlive it.
  LitSlices(const Shear& shear, const SheetWindow& window, std::span<const float> factors,
            const BandImage& band)
      : shear_(shear), window_(window), factors_(factors), band_(band) {}

  /// Rows of the n-th slice for slabs up to `reach` slices away, where `clip` shows them; null for null.
  /// Valid until the call for slice n + 2. Cost: a copy of the blocks.
  template <typename Clip>
  [[nodiscard]] const ShownRows* rows(const SliceSpans* slice, double reach, std::int64_t n, Clip& clip) {
    if (slice == nullptr) return nullptr;
    const auto place = static_cast<std::size_t>(n & 1);
    if (std::exchange(unlit_[place], slice) != slice) {
      const auto k = static_cast<double>(slice->number);
      RowRange rows = rows_of_band({shear_, window_, k - reach}, window_.scale, band_);
      rows.include(rows_of_band({shear_, window_, k + reach}, window_.scale, band_));
      light(*slice, reach, rows, clip.visible(k, rows.first, rows.last, reach), place);
    }
    return &shown_[place];
  }

 private:
  void light(const SliceSpans& slice, double reach, const RowRange& rows, std::span<const Blocks> visible,
             std::size_t place);
  void find_hidden(double k, double reach, ShownRows& shown);

  const Shear& shear_;
  const SheetWindow& window_;
  std::span<const float> factors_;
  const BandImage& band_;
  std::array<ShownRows, 2> shown_;
  std::array<const SliceSpans*, 2> unlit_{};
  std::vector<Blocks> opaque_;  // of each fine row
};

}  // namespace splatlas
