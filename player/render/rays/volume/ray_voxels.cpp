// Lighting of a ray volume's voxels, and structure numbers of voxels and cells, for id images.
#include <algorithm>

#include "format/result_macros.h"
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

Result<void> RayVolume::number(const SelectedRuns& runs, std::span<const StructureNumber> of_draw,
                               ThreadPool& pool) {
  if (empty() || numbers() != nullptr) return {};
  const auto& size = grid_.size;
  const std::size_t row = static_cast<std::size_t>(size[0]), slice = row * static_cast<std::size_t>(size[1]);
  const auto slices = static_cast<std::size_t>(size[2]);
  SPLATLAS_ASSIGN_OR_RETURN(SparseBytes voxels,
                            SparseBytes::reserve(slice * slices * sizeof(StructureNumber)));
  SPLATLAS_ASSIGN_OR_RETURN(cell_numbers_, SparseBytes::reserve(slice * slices * sizeof(StructureNumber)));
  auto* const numbers = reinterpret_cast<StructureNumber*>(voxels.data());
  auto* const cells = reinterpret_cast<StructureNumber*>(cell_numbers_.data());
  const auto place = [&](const ClassRun& run, std::size_t z) {
    return z * slice + static_cast<std::size_t>(run.row - first_[1]) * row +
           static_cast<std::size_t>(run.start - first_[0]);
  };
  const auto merge = [&](std::size_t first, std::size_t count, StructureNumber number) {
    for (std::size_t n = first; n < first + count; ++n)
      cells[n] = cells[n] == 0 || cells[n] == number ? number : kSeveralNumbers;
  };
  // Number the voxels of a slice, and the cells between it and the next one
  pool.for_each(slices - 1, [&](std::size_t z) {
    for (const std::size_t behind : {0u, 1u}) {
      const auto number_of_slice = static_cast<std::int64_t>(z + behind) + first_[2];
      runs.for_each(number_of_slice, [&](const ClassRun& run, std::uint32_t draw) {
        if (behind == 0) std::fill_n(numbers + place(run, z), run.length, of_draw[draw]);
        for (const std::size_t above : {std::size_t{0}, row})
          merge(place(run, z) - above - 1, run.length + std::size_t{1}, of_draw[draw]);
      });
    }
  });
  numbers_ = std::move(voxels);
  return {};
}

}  // namespace splatlas
