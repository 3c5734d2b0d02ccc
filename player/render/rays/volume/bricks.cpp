#include "player/render/rays/volume/bricks.h"

#include "format/tasks/task_control.h"

namespace splatlas {

std::vector<std::uint32_t> brick_sums(const BrickMask& mask) {
  const auto row = static_cast<std::size_t>(mask.x + 1);
  const std::size_t slice = row * static_cast<std::size_t>(mask.y + 1);
  std::vector<std::uint32_t> sums(slice * static_cast<std::size_t>(mask.z + 1), 0);
  for (std::int64_t k = 0; k < mask.z; ++k) {
    check_task();
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

void mark_slices(BrickMask& mask, const std::vector<std::vector<std::uint8_t>>& slices) {
  const std::size_t bricks = mask.of_slice();
  for (std::size_t slice = 0; slice < slices.size(); ++slice) {
    const std::size_t to = slice / MarchGrid::kBrick;
    const std::size_t from = slice == 0 ? 0 : (slice - 1) / MarchGrid::kBrick;
    for (std::size_t k = from; k <= to; ++k) {
      for (std::size_t n = 0; n < bricks; ++n) mask.bricks[k * bricks + n] |= slices[slice][n];
    }
  }
}

double bytes_of_ray_volume(const MarchGrid& grid, std::uint64_t runs) {
  constexpr double kBytesPerBrick = 16, kBytesPerSlice = 64, kVoxelBytes = 16, kPageBytes = 4096;
  constexpr double kPagesPerRun = 6, kRunBytes = 64;
  double bricks = 1, voxels = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    bricks *= static_cast<double>(grid.bricks(a));
    voxels *= static_cast<double>(grid.size[a]);
  }
  const auto all_runs = static_cast<double>(runs);
  return bricks * kBytesPerBrick + static_cast<double>(grid.size[2]) * kBytesPerSlice + all_runs * kRunBytes +
         std::min(kVoxelBytes * voxels, all_runs * kPagesPerRun * kPageBytes);
}

}  // namespace splatlas
