#include "player/spans/span_model.h"

namespace splatlas {

std::uint64_t span_model_bytes(std::uint64_t voxels, std::uint64_t runs) {
  // Worst case: every voxel is shaded, and every run is a span whose two end blocks are almost empty.
  // Transparent voxels split a run only at whole blocks, which saves memory.
  constexpr std::uint64_t kOptics = 4 * sizeof(float);
  return voxels * (kOptics + sizeof(ShadedVoxel)) + runs * (2 * kBlock * kOptics + sizeof(Span));
}

void shade_spans(SpanModel& model, std::span<const float> factors, ThreadPool& pool) {
  pool.for_each(model.slices.size(), [&](std::size_t n) {
    SliceSpans& slice = model.slices[n];
    for (const ShadedVoxel& voxel : slice.shaded) {
      for (std::size_t c = 0; c < static_cast<std::size_t>(slice.emissions); ++c)
        slice.optics.data()[voxel.place + (c + 1) * kBlock] = voxel.emission[c] * factors[voxel.normal];
    }
  });
}

}  // namespace splatlas
