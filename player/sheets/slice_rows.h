// Positions of the rows of a slice among the rows of the sheet.
#pragma once

#include <cmath>
#include <cstdint>

#include "player/sheets/sheet_window.h"
#include "player/view/shear.h"

namespace splatlas {

/// Positions of a slice's voxel rows among the fine rows. There are `scale` fine rows per voxel row.
class SliceRows {
 public:
  /// `k`: position of the slab along the principal axis.
  SliceRows(const Shear& shear, const SheetWindow& window, double k) : scale_(window.scale) {
    // Find the continuous fine row of voxel row 0
    const double fine = (shear.v_shift(k) - static_cast<double>(window.v0)) * static_cast<double>(scale_);
    first_ = static_cast<std::int64_t>(std::ceil(fine));
    rest_ = static_cast<double>(first_) - fine;
  }

  /// The n-th fine row between voxel rows `upper` and `upper` + 1.
  [[nodiscard]] std::int64_t fine_row(std::int64_t upper, std::int64_t n) const {
    return first_ + upper * scale_ + n;
  }
  /// The first voxel row whose n-th fine row is at or below `row`.
  [[nodiscard]] std::int64_t upper_from(std::int64_t n, std::int64_t row) const {
    const std::int64_t rows = row - n - first_;
    return rows >= 0 ? (rows + scale_ - 1) / scale_ : -(-rows / scale_);
  }
  /// Weight of the lower voxel row at the n-th fine row.
  [[nodiscard]] float lower_weight(std::int64_t n) const {
    return static_cast<float>((rest_ + static_cast<double>(n)) / static_cast<double>(scale_));
  }

 private:
  std::int64_t scale_, first_ = 0;
  double rest_ = 0;
};

}  // namespace splatlas
