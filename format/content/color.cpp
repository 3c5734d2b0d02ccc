#include "format/content/color.h"

#include <array>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "format/result_macros.h"

namespace splatlas {
namespace {

/// Converts hue, saturation and value, each 0 to 1, to sRGB.
Rgb from_hsv(double hue, double saturation, double value) {
  const auto channel = [&](double n) {
    const double k = std::fmod(n + hue * 6, 6);
    const double ramp = std::fmax(0, std::fmin(std::fmin(k, 4 - k), 1));
    return static_cast<std::uint8_t>(std::lround(255 * value * (1 - saturation * ramp)));
  };
  return {channel(5), channel(3), channel(1)};
}

}  // namespace

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
  // 2^64 / golden ratio: high bits of the product spread evenly on the hue circle (Fibonacci hashing).
  const std::uint64_t turn = static_cast<std::uint64_t>(n) * 0x9e3779b97f4a7c15u;
  const double hue = static_cast<double>(turn >> 11) * 0x1p-53;
  constexpr std::array<double, 3> kSaturation{0.62, 0.45, 0.8};
  constexpr std::array<double, 2> kValue{0.96, 0.8};
  return from_hsv(hue, kSaturation[n % 3], kValue[n / 3 % 2]);
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
