// Lighting of a ray volume's voxels.
#include "player/render/rays/volume/ray_volume.h"

namespace splatlas {

void RayVolume::light(const ParallelView& view, const Lighting& lighting, ThreadPool& pool) {
  if (lit_voxels_ == 0 || (lit_for_ && have_same_lighting(*lit_for_, view))) return;
  lit_for_.reset();
  const std::vector<float> factors = lighting.table();
  for (Source& source : sources_) {
    SparseBytes& bytes = source.transfer ? source.colors : source.values;
    // Colours of post-classified voxels come before their weight, those of others behind their extinction
    float* const colors = reinterpret_cast<float*>(bytes.data()) + (source.transfer ? 0 : 1);
    pool.for_each(source.lit.size(), [&](std::size_t slice) {
      float* const of_slice = colors + 4 * place(0, 0, static_cast<std::int64_t>(slice));
      for (const LitRun& run : source.lit[slice].runs) {
        float* color = of_slice + std::size_t{4} * run.number;
        const LitVoxel* voxel = source.lit[slice].voxels.data() + run.first;
        for (std::uint32_t n = 0; n < run.count; ++n, ++voxel, color += 4) {
          const float white = voxel->lit_white(factors[voxel->normal]);
          for (std::size_t c = 0; c < 3; ++c) color[c] = white * run.color[c];
        }
      }
    });
  }
  lit_for_ = view;
}

}  // namespace splatlas
