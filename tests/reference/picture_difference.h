// Differences between pictures.
#pragma once

#include <string>

#include "player/picture.h"
#include "tests/reference/reference_picture.h"

namespace splatlas::reference {

/// Over four channels and the union of both pictures (alpha above zero), in linear RGBA before rounding.
struct PictureDifference {
  double rms = 0, largest = 0;
  double mean = 0;          ///< signed: first picture minus second
  int column = 0, row = 0;  ///< position of the largest
  std::size_t pixels = 0;   ///< in the union
};

/// Pictures must have one size. A value that is not a number counts as an infinite difference.
[[nodiscard]] PictureDifference difference(const Picture& picture, const ReferencePicture& reference);
[[nodiscard]] PictureDifference difference(const ReferencePicture& a, const ReferencePicture& b);
[[nodiscard]] PictureDifference difference(const Picture& a, const Picture& b);

/// RMS difference over all pixels and channels, empty ones included, in 1/255.
[[nodiscard]] double whole_picture_rms(const Picture& a, const Picture& b);

/// In 1/255, with the position of the largest.
[[nodiscard]] std::string to_text(const PictureDifference& difference);

/// The largest violation of 0 <= alpha <= 1 and 0 <= color <= alpha; infinite for not-a-number.
[[nodiscard]] double energy_violation(const Picture& picture);

}  // namespace splatlas::reference
