#include "player/render/sheets/band_image.h"

#include <algorithm>

namespace splatlas {
namespace {

/// out[n * rows + r] = from[r][n]. `kRows`: their number, to unroll the loop, or 0.
template <std::size_t kRows>
void interleave(const std::vector<const float*>& from, std::int64_t count, float* out) {
  const std::size_t rows = kRows == 0 ? from.size() : kRows;
  for (std::int64_t n = 0; n < count; ++n) {
    for (std::size_t r = 0; r < rows; ++r) out[static_cast<std::size_t>(n) * rows + r] = from[r][n];
  }
}

}  // namespace

void BandImage::store(std::int64_t last, SheetImage& sheet) const {
  std::vector<const float*> phase_rows;  // of every plane
  for (std::int64_t fine_row = first_; fine_row < last; ++fine_row) {
    phase_rows.clear();
    for (std::int64_t phase = 0; phase < scale_; ++phase) {
      for (std::int64_t plane = 0; plane < planes_; ++plane)
        phase_rows.push_back(row(fine_row, phase) + plane * stride_);
    }
    float* out = &sheet.pixels[static_cast<std::size_t>((fine_row + 1) * sheet.stride() * sheet.channels)];
    std::fill_n(out, sheet.channels, 0.0f);
    float* const pixels = out + sheet.channels;
    switch (phase_rows.size()) {
      case 2: interleave<2>(phase_rows, columns_, pixels); break;
      case 4: interleave<4>(phase_rows, columns_, pixels); break;
      case 8: interleave<8>(phase_rows, columns_, pixels); break;
      default: interleave<0>(phase_rows, columns_, pixels);
    }
    std::fill_n(out + (sheet.stride() - 1) * sheet.channels, sheet.channels, 0.0f);
  }
}

}  // namespace splatlas
