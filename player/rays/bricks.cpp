#include "player/rays/bricks.h"

namespace splatlas {

std::vector<std::uint32_t> brick_sums(const BrickMask& mask) {
  const auto row = static_cast<std::size_t>(mask.x + 1);
  const std::size_t slice = row * static_cast<std::size_t>(mask.y + 1);
  std::vector<std::uint32_t> sums(slice * static_cast<std::size_t>(mask.z + 1), 0);
  for (std::int64_t k = 0; k < mask.z; ++k) {
    for (std::int64_t j = 0; j < mask.y; ++j) {
      std::uint32_t in_row = 0;
      for (std::int64_t i = 0; i < mask.x; ++i) {
        in_row += mask.bricks[mask.number(i, j, k)] != 0 ? 1 : 0;
        const std::size_t at = static_cast<std::size_t>(k + 1) * slice +
                               static_cast<std::size_t>(j + 1) * row + static_cast<std::size_t>(i + 1);
        sums[at] = in_row + sums[at - row] + sums[at - slice] - sums[at - slice - row];
      }
    }
  }
  return sums;
}

Work work_of_ray_volume(const MarchGrid& grid, std::uint64_t runs) {
  constexpr double kPerBrick = 60, kBytesPerBrick = 16, kPerSlice = 200, kBytesPerSlice = 64;
  constexpr double kVoxelBytes = 16, kPageBytes = 4096, kPagesPerRun = 6, kRunBytes = 64;
  double bricks = 1, voxels = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    bricks *= static_cast<double>(grid.bricks(a));
    voxels *= static_cast<double>(grid.size[a]);
  }
  const auto slices = static_cast<double>(grid.size[2]), all_runs = static_cast<double>(runs);
  Work work;
  work.add(WorkKind::kRows, bricks, kPerBrick);
  work.add(WorkKind::kRows, slices, kPerSlice);
  work.hold(bricks * kBytesPerBrick + slices * kBytesPerSlice + all_runs * kRunBytes +
            std::min(kVoxelBytes * voxels, all_runs * kPagesPerRun * kPageBytes));
  return work;
}

}  // namespace splatlas
