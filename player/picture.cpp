#include "player/picture.h"

#include <algorithm>
#include <cmath>

namespace splatlas {
namespace {

/// IEC 61966-2-1, rounded to 8 bits through a table: 12-bit steps near black are finer than a code value
/// there.
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
    const float clamped = std::clamp(linear, 0.0f, 1.0f);
    return codes_[static_cast<std::size_t>(clamped * static_cast<float>(codes_.size() - 1) + 0.5f)];
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
    const float straight = p[3] > 0 ? 1.0f / p[3] : 0.0f;
    for (std::size_t c = 0; c < 3; ++c) bytes[4 * n + c] = encode(p[c] * straight);
    bytes[4 * n + 3] = static_cast<std::uint8_t>(std::lround(255.0f * std::clamp(p[3], 0.0f, 1.0f)));
  }
  return bytes;
}

}  // namespace splatlas
