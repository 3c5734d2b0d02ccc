// The nose of a head, by which a person may be recognised.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "format/content/grid.h"

namespace splatlas {

/// The front of a nose, halfway up: for 10 mm upwards, the front of the mask rises by 12 mm and more over the
/// points 25 mm to both sides, where the mask is 90 to 230 mm wide. Foreheads, brains and cut faces are
/// flatter. `grid` is a storage grid. Linear in the voxels.
[[nodiscard]] std::optional<Index3> find_nose(std::span<const std::uint8_t> mask, const Grid& grid);

}  // namespace splatlas
