// Accumulation buffer of a band of the sheet.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "player/render/sheets/splat/splat_kernels.h"
#include "player/render/sheets/warp/sheet_image.h"
#include "player/render/view/sheet_window.h"

namespace splatlas {

/// Radiance and opacity of fine rows [first, last) of a window. Layout: [fine row][phase][plane][stride()],
/// with planes of emissions (red, green, blue, or white alone), then opacity. One pixel before and one after
/// each row are readable.
class BandImage {
 public:
  /// A transparent image in the memory of `floats`, which must outlive it.
  BandImage(const SheetWindow& window, int emissions, std::int64_t first, std::int64_t last,
            std::vector<float>& floats)
      : scale_(window.scale),
        columns_(window.columns),
        planes_(1 + emissions),
        stride_(stride(window)),
        first_(first),
        last_(last),
        floats_(floats) {
    floats_.assign(static_cast<std::size_t>((last_ - first_) * row_stride()), 0.0f);
    opaque_.resize(static_cast<std::size_t>((last_ - first_) * scale_));
  }

  /// Floats of a plane of a row, with margins, rounded up to whole blocks.
  static std::int64_t stride(const SheetWindow& window) {
    return (window.columns + 2 * ImageRows::kMargin + kBlock - 1) / kBlock * kBlock;
  }

  /// Place of pixel 0 of the first plane in the floats of the image. `fine_row`: from the first one.
  static std::int64_t begin_of(std::int64_t fine_row, std::int64_t phase, const SheetWindow& window,
                               std::int64_t planes) {
    return (fine_row * window.scale + phase) * planes * stride(window) + ImageRows::kMargin;
  }
  [[nodiscard]] const float* begin() const { return floats_.data(); }

  [[nodiscard]] std::int64_t first_fine_row() const { return first_; }
  [[nodiscard]] std::int64_t last_fine_row() const { return last_; }
  [[nodiscard]] std::int64_t planes() const { return planes_; }
  [[nodiscard]] std::int64_t plane_stride() const { return stride_; }
  [[nodiscard]] std::int64_t row_stride() const { return scale_ * phase_stride(); }

  /// Pixel 0 of the first plane.
  [[nodiscard]] const float* row(std::int64_t fine_row, std::int64_t phase) const {
    return floats_.data() + (fine_row - first_) * row_stride() + phase * phase_stride() + ImageRows::kMargin;
  }
  /// Kernel access from a fine row and a phase on. Pairs of voxel rows are `scale` fine rows apart.
  [[nodiscard]] ImageRows rows(std::int64_t fine_row, std::int64_t phase) {
    float* pixels =
        floats_.data() + (fine_row - first_) * row_stride() + phase * phase_stride() + ImageRows::kMargin;
    return {pixels,
            columns_,
            stride_,
            phase_stride(),
            row_stride(),
            row_stride() * scale_,
            opaque_.data() + (fine_row - first_) * scale_ + phase,
            scale_,
            scale_ * scale_};
  }

  /// Interleaves phases and planes into the rows of the finished sheet, up to fine row `last`.
  void store(std::int64_t last, SheetImage& sheet) const;

 private:
  [[nodiscard]] std::int64_t phase_stride() const { return planes_ * stride_; }

  std::int64_t scale_, columns_, planes_, stride_, first_, last_;
  std::vector<float>& floats_;
  std::vector<OpaquePixels> opaque_;  // row major: [fine row][phase]
};

}  // namespace splatlas
