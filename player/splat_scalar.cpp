#include <cmath>

#include "player/splat_kernels.h"

namespace splatlas {
namespace {

void splat(const float* light, std::size_t light_stride, std::size_t count, float weight_here,
           float weight_before, float* row, std::size_t row_stride) {
  for (std::size_t plane = 0; plane < 4; ++plane) {
    const float* from = light + plane * light_stride;
    float* to = row + plane * row_stride;
    float before = from[-1];
    for (std::size_t n = 0; n < count; ++n) {
      to[n] += weight_here * from[n] + weight_before * before;
      before = from[n];
    }
  }
}

void composite(float* row, std::size_t row_stride, std::size_t count, float slab_mm, float* image,
               std::size_t image_stride) {
  for (std::size_t n = 0; n < count; ++n) {
    const float depth = row[n] * slab_mm;
    if (depth > 0) {
      float& opacity = image[3 * image_stride + n];
      const float through = 1 - opacity;
      const float absorbed = -std::expm1(-depth);  // without cancellation for thin slabs
      const float weight = through * slab_mm * (absorbed / depth);
      for (std::size_t c = 0; c < 3; ++c)
        image[c * image_stride + n] += weight * row[(c + 1) * row_stride + n];
      opacity += through * absorbed;
    }
    for (std::size_t plane = 0; plane < 4; ++plane) row[plane * row_stride + n] = 0;
  }
}

}  // namespace

const SplatKernels& scalar_kernels() {
  static constexpr SplatKernels kKernels{"scalar", splat, composite};
  return kKernels;
}

}  // namespace splatlas
