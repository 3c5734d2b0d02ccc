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

}  // namespace splatlas
