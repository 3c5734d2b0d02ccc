// How far two pictures are apart.
#pragma once

#include <string>

#include "player/picture.h"
#include "tests/reference/reference_picture.h"

namespace splatlas::reference {

/// Over the four channels of the union of what both pictures show (alpha above zero), linear light, before
/// any rounding to 8 bits.
struct PictureDifference {
  double rms = 0, largest = 0;
  double mean = 0;          ///< signed: of the first picture less the second
  int column = 0, row = 0;  ///< where the largest is
  std::size_t pixels = 0;   ///< of the union
};

/// Pictures of one size. A value that is not a number counts as an infinite difference.
[[nodiscard]] PictureDifference difference(const Picture& picture, const ReferencePicture& reference);
[[nodiscard]] PictureDifference difference(const ReferencePicture& a, const ReferencePicture& b);
[[nodiscard]] PictureDifference difference(const Picture& a, const Picture& b);

/// The root mean square over all pixels and channels, whether anything is shown there or not, in 1/255.
[[nodiscard]] double whole_picture_rms(const Picture& a, const Picture& b);

/// In 1/255, with the place of the largest.
[[nodiscard]] std::string to_text(const PictureDifference& difference);

/// The largest violation of 0 <= alpha <= 1 and 0 <= color <= alpha; infinite for values that are not
/// numbers.
[[nodiscard]] double energy_violation(const Picture& picture);

}  // namespace splatlas::reference
