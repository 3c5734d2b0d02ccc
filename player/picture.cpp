#include "player/picture.h"

#include <algorithm>
#include <cmath>

namespace splatlas {
namespace {

/// Clamps to [0, 1]; NaN counts as 0.
float unit(float value) {
  return value > 0 ? std::min(value, 1.0f) : 0.0f;
}

/// Look-up table of the sRGB transfer function (IEC 61966-2-1), rounded to 8 bits. Its step is at most a
/// tenth of a code value, near black.
class SrgbEncoder {
 public:
  SrgbEncoder() {
    for (std::size_t n = 0; n < codes_.size(); ++n) {
      const double linear = static_cast<double>(n) / static_cast<double>(codes_.size() - 1);
      const double encoded = linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
      codes_[n] = static_cast<std::uint8_t>(std::lround(255.0 * encoded));
    }
  }
  [[nodiscard]] std::uint8_t operator()(float linear) const {
    return codes_[static_cast<std::size_t>(unit(linear) * static_cast<float>(codes_.size() - 1) + 0.5f)];
  }

 private:
  std::array<std::uint8_t, 32769> codes_{};
};

const SrgbEncoder& srgb_encoder() {
  static const SrgbEncoder encoder;
  return encoder;
}

}  // namespace

std::vector<std::uint8_t> to_srgb8(const Picture& picture, Rgb background) {
  const SrgbEncoder& encode = srgb_encoder();
  const std::array<float, 3> behind{srgb_to_linear(background.r), srgb_to_linear(background.g),
                                    srgb_to_linear(background.b)};
  const std::size_t pixels = picture.rgba.size() / 4;
  std::vector<std::uint8_t> bytes(3 * pixels);
  for (std::size_t n = 0; n < pixels; ++n) {
    const float* p = &picture.rgba[4 * n];
    for (std::size_t c = 0; c < 3; ++c) bytes[3 * n + c] = encode(p[c] + (1.0f - p[3]) * behind[c]);
  }
  return bytes;
}

std::vector<std::uint8_t> to_srgba8(const Picture& picture) {
  const SrgbEncoder& encode = srgb_encoder();
  const std::size_t pixels = picture.rgba.size() / 4;
  std::vector<std::uint8_t> bytes(4 * pixels);
  for (std::size_t n = 0; n < pixels; ++n) {
    const float* p = &picture.rgba[4 * n];
    // Divide: the reciprocal of the smallest opacities is infinite.
    for (std::size_t c = 0; c < 3; ++c) bytes[4 * n + c] = encode(p[3] > 0 ? p[c] / p[3] : 0.0f);
    bytes[4 * n + 3] = static_cast<std::uint8_t>(std::lround(255.0f * unit(p[3])));
  }
  return bytes;
}

}  // namespace splatlas
