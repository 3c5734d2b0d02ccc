// Lighting of a ray volume's voxels.
#include "player/render/rays/volume/ray_volume.h"

namespace splatlas {

void RayVolume::light(const ParallelView& view, const Lighting& lighting, ThreadPool& pool) {
  if (shaded_voxels_ == 0 || (lit_for_ && have_same_lighting(*lit_for_, view))) return;
  lit_for_.reset();
  const std::vector<float> factors = lighting.table();
  for (Source& source : sources_) {
    SparseBytes& bytes = source.transfer ? source.colors : source.values;
    auto* colors = reinterpret_cast<float*>(bytes.data());
    pool.for_each(source.shaded.size(), [&](std::size_t slice) {
      for (const ShadedVoxel& voxel : source.shaded[slice]) {
        const float factor = lit_factor(factors[voxel.normal], voxel.lit);
        for (std::size_t c = 0; c < 3; ++c) colors[voxel.place + c] = voxel.color[c] * factor;
      }
    });
  }
  lit_for_ = view;
}

}  // namespace splatlas
