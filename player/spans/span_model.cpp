#include "player/spans/span_model.h"

namespace splatlas {

std::uint64_t span_model_bytes(std::uint64_t voxels, std::uint64_t runs) {
  // As if every voxel were shaded, and every run a span of its own with blocks that it hardly fills. Voxels
  // that grey values leave out make runs into several spans only where whole blocks are left out.
  constexpr std::uint64_t kLight = 4 * sizeof(float);
  return voxels * (kLight + sizeof(ShadedVoxel)) + runs * (2 * kBlock * kLight + sizeof(Span));
}

void shade_spans(SpanModel& model, std::span<const float> light, ThreadPool& pool) {
  pool.for_each(model.slices.size(), [&](std::size_t n) {
    SliceSpans& slice = model.slices[n];
    for (const ShadedVoxel& voxel : slice.shaded) {
      for (std::size_t c = 0; c < static_cast<std::size_t>(slice.emissions); ++c)
        slice.light.data()[voxel.place + (c + 1) * kBlock] = voxel.emission[c] * light[voxel.normal];
    }
  });
}

}  // namespace splatlas
