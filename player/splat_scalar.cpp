#include <array>
#include <cmath>

#include "player/block_runs.h"
#include "player/splat_kernels.h"

namespace splatlas {
namespace {

/// Light of one voxel of the mixed row, by plane.
using Mixed = std::array<float, kPlanes>;

Mixed mixed(const SheetRow& row, const BlockRun& run, std::int64_t block, std::int64_t n) {
  const std::int64_t at = (block - run.first) * kBlockFloats + n;
  Mixed light{};
  for (std::size_t plane = 0; plane < kPlanes; ++plane) {
    const std::int64_t offset = at + static_cast<std::int64_t>(plane) * kBlock;
    if (run.near != nullptr) light[plane] += row.near_weight * run.near[offset];
    if (run.far != nullptr) light[plane] += row.far_weight * run.far[offset];
  }
  return light;
}

void composite_pixel(const Mixed& light, float slab_mm, float* pixel, std::size_t stride) {
  const float depth = light[0] * slab_mm;
  if (depth <= 0) return;
  float& opacity = pixel[3 * stride];
  const float through = 1 - opacity;
  const float absorbed = -std::expm1(-depth);  // without cancellation for thin slabs
  const float weight = through * slab_mm * (absorbed / depth);
  for (std::size_t c = 0; c < 3; ++c) pixel[c * stride] += weight * light[c + 1];
  opacity += through * absorbed;
}

void composite(const SheetRow& row, float slab_mm, float floor, const ImageRow& image) {
  BlockRuns runs(row, image);
  Mixed before{};
  std::int64_t next_block = 0;
  for (BlockRun run; runs.next(run);) {
    if (run.first != next_block) before = {};
    next_block = run.last;
    for (std::int64_t block = run.first; block < run.last; ++block) {
      float* pixels = image.planes + block * kBlock + row.shift;
      const float* opacity = pixels + 3 * image.stride;
      const bool opaque = std::all_of(opacity, opacity + kBlock, [&](float o) { return 1 - o <= floor; });
      for (std::int64_t n = 0; n < kBlock; ++n) {
        const Mixed here = mixed(row, run, block, n);
        if (!opaque) {
          Mixed light{};
          for (std::size_t plane = 0; plane < kPlanes; ++plane)
            light[plane] = row.here * here[plane] + row.before * before[plane];
          composite_pixel(light, slab_mm, pixels + n, image.stride);
        }
        before = here;
      }
    }
  }
}

}  // namespace

const SplatKernels& scalar_kernels() {
  static constexpr SplatKernels kKernels{"scalar", composite};
  return kKernels;
}

}  // namespace splatlas
