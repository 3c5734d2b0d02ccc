// Structure numbers of a ray volume's voxels and cells, for id images.
#include <algorithm>

#include "format/result_macros.h"
#include "player/render/rays/volume/ray_volume.h"

namespace splatlas {

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
