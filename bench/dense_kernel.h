// The machine's limit: compositing a dense volume with nothing else to do.
#pragma once

#include <cstdint>
#include <vector>

namespace splatlas {

/// A volume of planar floats, premultiplied: for every row of a slice, `planes` - 1 colours and then
/// opacities, one per voxel, each plane `stride()` long. kPad more behind the last.
struct DenseVolume {
  std::int64_t columns = 0, rows = 0, slices = 0;
  int planes = 4;
  std::vector<float> values;

  [[nodiscard]] std::int64_t stride() const { return (columns + kPad) / kPad * kPad; }
  [[nodiscard]] const float* row(std::int64_t slice, std::int64_t y) const {
    return values.data() + (slice * (rows + 1) + y) * planes * stride();
  }
  static constexpr std::int64_t kPad = 16;  ///< voxels that may be read behind a row, at least one

  /// Thin fog that no vector can take for constant.
  [[nodiscard]] static DenseVolume fog(std::int64_t columns, std::int64_t rows, std::int64_t slices,
                                       int planes);
};

/// A sheet of `scale` x `scale` pixels per voxel of the volume's rows and columns, interleaved as sheets of
/// one pixel per voxel: [row][phase][plane][stride()].
struct DenseSheet {
  int scale = 1;
  std::vector<float> pixels;
};

/// Composites all slices, front to back, in a plain loop (Highway, the machine's best vectors): every pixel
/// of every slice is the mean of four voxels with bilinear weights that shift from slice to slice, put under
/// what is there (out += (1 - alpha) * in). Nothing is skipped, no exponential taken. Bands of rows pass
/// through all slices, so that what is accumulated stays in the cache. One thread. Cost: samples() of these.
void composite_dense(const DenseVolume& volume, DenseSheet& sheet);

/// Pixels times slices.
[[nodiscard]] inline std::uint64_t samples(const DenseVolume& volume, int scale) {
  return static_cast<std::uint64_t>(volume.columns * volume.rows * volume.slices) *
         static_cast<std::uint64_t>(scale * scale);
}

}  // namespace splatlas
