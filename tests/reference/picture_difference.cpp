#include "tests/reference/picture_difference.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace splatlas::reference {
namespace {

ReferencePicture as_reference(const Picture& picture) {
  ReferencePicture converted{picture.size, {}};
  for (std::size_t n = 0; n < picture.rgba.size(); n += 4) {
    converted.pixels.push_back(
        {picture.rgba[n], picture.rgba[n + 1], picture.rgba[n + 2], picture.rgba[n + 3]});
  }
  return converted;
}

}  // namespace

PictureDifference difference(const ReferencePicture& a, const ReferencePicture& b) {
  PictureDifference result;
  double squares = 0;
  double sum = 0;
  for (std::size_t n = 0; n < a.pixels.size(); ++n) {
    const bool shown = !(a.pixels[n][3] <= 0 && b.pixels[n][3] <= 0);
    if (shown) ++result.pixels;
    for (std::size_t c = 0; c < 4; ++c) {
      double d = a.pixels[n][c] - b.pixels[n][c];
      if (!std::isfinite(d)) d = std::numeric_limits<double>::infinity();
      if (std::abs(d) > result.largest) {
        result.largest = std::abs(d);
        result.column = static_cast<int>(n) % a.size.width;
        result.row = static_cast<int>(n) / a.size.width;
      }
      if (!shown) continue;
      squares += d * d;
      sum += d;
    }
  }
  if (result.pixels > 0) {
    const double values = 4 * static_cast<double>(result.pixels);
    result.rms = std::sqrt(squares / values);
    result.mean = sum / values;
  }
  return result;
}

PictureDifference difference(const Picture& picture, const ReferencePicture& reference) {
  return difference(as_reference(picture), reference);
}

PictureDifference difference(const Picture& a, const Picture& b) {
  return difference(as_reference(a), as_reference(b));
}

double whole_picture_rms(const Picture& a, const Picture& b) {
  double squares = 0;
  for (std::size_t n = 0; n < a.rgba.size(); ++n) {
    const double d = static_cast<double>(a.rgba[n]) - static_cast<double>(b.rgba[n]);
    squares += d * d;
  }
  return 255 * std::sqrt(squares / static_cast<double>(a.rgba.size()));
}

std::string to_text(const PictureDifference& d) {
  std::ostringstream text;
  text << "RMS " << 255 * d.rms << "/255, largest " << 255 * d.largest << "/255 at (" << d.column << ", "
       << d.row << "), mean " << 255 * d.mean << "/255, " << d.pixels << " pixels";
  return text.str();
}

double energy_violation(const Picture& picture) {
  double worst = 0;
  for (std::size_t n = 0; n < picture.rgba.size(); n += 4) {
    const double alpha = picture.rgba[n + 3];
    if (!std::isfinite(alpha)) return std::numeric_limits<double>::infinity();
    worst = std::max({worst, -alpha, alpha - 1});
    for (std::size_t c = 0; c < 3; ++c) {
      const double color = picture.rgba[n + c];
      if (!std::isfinite(color)) return std::numeric_limits<double>::infinity();
      worst = std::max({worst, -color, color - alpha});
    }
  }
  return worst;
}

}  // namespace splatlas::reference
