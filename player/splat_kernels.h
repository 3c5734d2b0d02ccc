// HOT LOOP: the two inner loops of sheet splatting, chosen once per frame for the machine at hand.
#pragma once

#include <cstddef>

namespace splatlas {

/// Rows of a sheet are four planes of floats, `stride` apart: extinction, red, green, blue (1/mm).
/// Rows of the image accumulated so far are four planes: red, green, blue (premultiplied, linear), opacity.
struct SplatKernels {
  const char* name;  ///< "scalar", or the instruction set

  /// Adds one span's footprints to a row of the sheet, for all planes:
  ///   row[n] += weight_here * light[n] + weight_before * light[n - 1],  0 <= n < count.
  /// In the sheared grid every voxel of a slice has the same sub-pixel offset, so the (bilinear) footprint's
  /// weights are constants and splatting is a two-tap convolution. light[-1] must be readable. Up to
  /// kSpanPadding - 1 floats past `count` may be read and added (they must be readable and writable; a span's
  /// padding is zero).
  void (*splat)(const float* light, std::size_t light_stride, std::size_t count, float weight_here,
                float weight_before, float* row, std::size_t row_stride);

  /// Composites `count` pixels (a multiple of kSpanPadding) of a sheet's row behind what is accumulated, and
  /// clears the row. Along a slab of `slab_mm` extinction k and emission e are constant, so exactly
  ///   colour += (1 - opacity) * e * (1 - exp(-k d)) / k,   opacity += (1 - opacity) * (1 - exp(-k d)).
  void (*composite)(float* row, std::size_t row_stride, std::size_t count, float slab_mm, float* image,
                    std::size_t image_stride);
};

/// Plain C++, the twin that others are compared with.
[[nodiscard]] const SplatKernels& scalar_kernels();
/// The best that this machine runs (Highway, dispatched at run time). Agrees with the scalar twin to about
/// 1e-6 of the largest value. SPLATLAS_SIMD=scalar in the environment forces the twin.
[[nodiscard]] const SplatKernels& best_kernels();

}  // namespace splatlas
