#include <algorithm>

#include "format/system/result_macros.h"
#include "player/rays/ray_volume.h"

namespace splatlas {

Result<void> RayVolume::number(const SelectedRuns& runs, std::span<const StructureNumber> of_draw,
                               ThreadPool& pool) {
  if (empty() || numbers() != nullptr) return {};
  const auto& size = grid_.size;
  const std::size_t row = static_cast<std::size_t>(size[0]), slice = row * static_cast<std::size_t>(size[1]);
  const auto slices = static_cast<std::size_t>(size[2]);
  SPLATLAS_ASSIGN_OR_RETURN(numbers_, SparseBytes::reserve(slice * slices * sizeof(StructureNumber)));
  auto* const numbers = reinterpret_cast<StructureNumber*>(numbers_.data());
  pool.for_each(slices, [&](std::size_t z) {
    runs.for_each(static_cast<std::int64_t>(z) + first_[2], [&](const ClassRun& run, std::uint32_t draw) {
      const std::size_t place = z * slice + static_cast<std::size_t>(run.row - first_[1]) * row +
                                static_cast<std::size_t>(run.start - first_[0]);
      std::fill_n(numbers + place, run.length, of_draw[draw]);
    });
  });
  return {};
}

}  // namespace splatlas
