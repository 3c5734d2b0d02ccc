#include "player/picture.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "format/tasks/task_control.h"
#include "format/text/ascii_text.h"

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
      codes_[n] = static_cast<std::uint8_t>(std::lround(255.0 * encode_srgb(linear)));
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

/// Throws Cancelled in a task that is to stop; looks at every 2^14th of `n`.
void check_stop(std::size_t n) {
  if ((n & 0x3fff) == 0 && is_task_stopped()) throw Cancelled();
}

}  // namespace

std::vector<std::uint8_t> to_srgb8(const Picture& picture, Rgb background) {
  const SrgbEncoder& encode = srgb_encoder();
  const std::array<float, 3> behind{srgb_to_linear(background.r), srgb_to_linear(background.g),
                                    srgb_to_linear(background.b)};
  std::vector<std::uint8_t> bytes(picture.rgba.size() / 4 * 3);
  for (std::size_t n = 0; n < bytes.size() / 3; ++n) {
    check_stop(n);
    const float* p = &picture.rgba[4 * n];
    for (std::size_t c = 0; c < 3; ++c) bytes[3 * n + c] = encode(p[c] + (1.0f - p[3]) * behind[c]);
  }
  return bytes;
}

void to_srgba8(std::span<const float> rgba, std::uint8_t* out) {
  const SrgbEncoder& encode = srgb_encoder();
  for (std::size_t n = 0; n < rgba.size() / 4; ++n) {
    check_stop(n);
    const float* p = &rgba[4 * n];
    out[4 * n + 3] = static_cast<std::uint8_t>(255.0f * unit(p[3]) + 0.5);  // a faster std::lround()
    // Divide: the reciprocal of the smallest opacities is infinite.
    for (std::size_t c = 0; c < 3; ++c) out[4 * n + c] = p[3] > 0 ? encode(p[c] / p[3]) : 0;
  }
}

std::vector<std::uint8_t> to_srgba8(const Picture& picture) {
  std::vector<std::uint8_t> bytes(picture.rgba.size());
  to_srgba8(picture.rgba, bytes.data());
  return bytes;
}

std::string describe(const MissingPart& missing, const StructureGraph& graph) {
  const std::string what = missing.surface ? "surface" : fmt::format("volume of {} voxels", missing.voxels);
  return fmt::format("{}: its {} is missing: {}", in_quotes(graph[missing.structure].id), what,
                     missing.error.message);
}

}  // namespace splatlas
