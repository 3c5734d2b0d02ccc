// How large and how far away things may be, in mm.
#pragma once

#include <algorithm>
#include <cmath>

#include "format/grid.h"

namespace splatlas {

/// Spacings of a valid grid are from the first to the second, places at most kFurthestMm from LPS's origin
/// along each axis: more than is ever scanned, and no product of the few that geometry multiplies overflows
/// or vanishes.
inline constexpr double kMinSpacingMm = 1e-9, kMaxSpacingMm = 1e9, kFurthestMm = 1e15;
/// Columns of a grid's direction, whose length should be 1.
inline constexpr double kMinColumnLength = 1e-3, kMaxColumnLength = 1e3;

[[nodiscard]] inline bool is_within_reach(const Vec3& place_lps_mm) {
  return std::ranges::all_of(place_lps_mm, [](double mm) { return std::abs(mm) <= kFurthestMm; });
}

}  // namespace splatlas
