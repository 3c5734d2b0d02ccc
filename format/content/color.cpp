#include "format/content/color.h"

#include <array>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "format/result_macros.h"

namespace splatlas {

std::string to_hex(Rgb color) {
  return fmt::format("#{:02x}{:02x}{:02x}", color.r, color.g, color.b);
}

Result<Rgb> parse_color(std::string_view text) {
  const auto refuse = [&] { return fail(ErrorCode::kUsage, "\"{}\" is not a color: write #rrggbb", text); };
  if ((text.size() != 4 && text.size() != 7) || text[0] != '#') return refuse();
  const std::size_t digits = text.size() / 3;  // per channel
  std::array<std::uint8_t, 3> channels{};
  for (std::size_t n = 0; n < 3; ++n) {
    const std::string_view part = text.substr(1 + n * digits, digits);
    const auto [end, error] = std::from_chars(part.data(), part.data() + digits, channels[n], 16);
    if (error != std::errc() || end != part.data() + digits) return refuse();
    if (digits == 1) channels[n] = static_cast<std::uint8_t>(channels[n] * 17);
  }
  return Rgb{channels[0], channels[1], channels[2]};
}

Rgb default_color(std::size_t n) {
  constexpr std::array<std::uint32_t, kDefaultColors> kColors{0xeebb00, 0x5555ff, 0xdd0000, 0x66ddaa,
                                                              0xbb00bb, 0x55aa99, 0xccbbff, 0xdd8822,
                                                              0xaaffff, 0x886677, 0xaa88ee, 0xffff00};
  const std::uint32_t code = kColors[n % kColors.size()];
  return {static_cast<std::uint8_t>(code >> 16), static_cast<std::uint8_t>(code >> 8 & 0xff),
          static_cast<std::uint8_t>(code & 0xff)};
}

double encode_srgb(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

double decode_srgb(double code) {
  return code <= 0.04045 ? code / 12.92 : std::pow((code + 0.055) / 1.055, 2.4);
}

float srgb_to_linear(std::uint8_t channel) {
  return static_cast<float>(decode_srgb(channel / 255.0));
}

}  // namespace splatlas
