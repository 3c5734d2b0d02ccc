// Dense compositing kernel: the limit of the machine.
#pragma once

#include <cstdint>
#include <vector>

namespace splatlas {

/// A volume of planar premultiplied floats. For each row of a slice: `planes` - 1 colours, then opacities,
/// one per voxel; each plane is `stride()` long. kPad more at the end.
struct DenseVolume {
  std::int64_t columns = 0, rows = 0, slices = 0;
  int planes = 4;
  std::vector<float> values;

  [[nodiscard]] std::int64_t stride() const { return (columns + kPad) / kPad * kPad; }
  [[nodiscard]] const float* row(std::int64_t slice, std::int64_t y) const {
    return values.data() + (slice * (rows + 1) + y) * planes * stride();
  }
  static constexpr std::int64_t kPad = 16;  ///< readable voxels behind a row, at least one

  /// Thin fog that varies, so that no kernel can treat it as constant.
  [[nodiscard]] static DenseVolume fog(std::int64_t columns, std::int64_t rows, std::int64_t slices,
                                       int planes);
};

/// A sheet of `scale` x `scale` pixels per voxel of rows and columns, interleaved like sheets of one pixel
/// per voxel: [row][phase][plane][stride()].
struct DenseSheet {
  int scale = 1;
  std::vector<float> pixels;
};

/// Composites all slices front to back (Highway, best available vectors). Every pixel of a slice is the mean
/// of four voxels with bilinear weights that change per slice, composited under the previous ones: out += (1
/// - alpha) * in. Nothing is skipped, and no exponential is evaluated. Bands of rows pass through all slices,
/// so that the accumulated pixels stay in the cache. One thread. Cost: pixels times slices.
void composite_dense(const DenseVolume& volume, DenseSheet& sheet);

}  // namespace splatlas
