// Length of a scale bar, and anatomical directions of a picture's edges.
#pragma once

#include <string>

#include "format/content/grid.h"

namespace splatlas {

/// The longest of 1, 2 and 5 times a power of ten that is at most `max_mm`; 0 if `max_mm` is not positive.
[[nodiscard]] double scale_bar_mm(double max_mm);
/// "20 mm" or "0.5 mm".
[[nodiscard]] std::string length_text(double mm);

/// Letters of the anatomical directions in which a unit vector in LPS points: L, R, A, P, S and I. As a
/// compass with 45 degrees between its directions: each direction at most 67.5 degrees away has a letter,
/// the nearest one first ("LA").
[[nodiscard]] std::string direction_letters(const Vec3& direction_lps);

}  // namespace splatlas
