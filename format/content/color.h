// sRGB colours and their text form.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "format/result.h"

namespace splatlas {

/// sRGB colour, 8 bits per channel.
struct Rgb {
  std::uint8_t r = 255, g = 255, b = 255;
  friend bool operator==(const Rgb&, const Rgb&) = default;
};

/// Formats as "#rrggbb", lower case.
[[nodiscard]] std::string to_hex(Rgb color);
/// Parses "#rrggbb" or "#rgb", upper or lower case; kUsage otherwise.
[[nodiscard]] Result<Rgb> parse_color(std::string_view text);
inline constexpr std::size_t kDefaultColors = 12;
/// The n-th colour of a palette, again from the first after kDefaultColors. Found by a search: of light
/// colours, any two have a color_distance() of at least 0.112 for every sight.
[[nodiscard]] Rgb default_color(std::size_t n);
/// The sRGB curve, IEC 61966-2-1: from linear light to code values and back, both from 0 to 1.
[[nodiscard]] double encode_srgb(double linear);
[[nodiscard]] double decode_srgb(double code);
/// Converts an sRGB channel (0 to 255) to linear RGB (0 to 1).
[[nodiscard]] float srgb_to_linear(std::uint8_t channel);

}  // namespace splatlas
