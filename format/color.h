// Colours as people write them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "format/result.h"

namespace splatlas {

/// sRGB, 8 bits a channel.
struct Rgb {
  std::uint8_t r = 255, g = 255, b = 255;
  friend bool operator==(const Rgb&, const Rgb&) = default;
};

/// "#rrggbb", lower case.
[[nodiscard]] std::string to_hex(Rgb color);
/// Takes "#rrggbb" or "#rgb", upper or lower case; kUsage otherwise.
[[nodiscard]] Result<Rgb> parse_color(std::string_view text);
/// A distinct colour for the n-th structure of an atlas that names none: golden-angle hues, never too dark.
[[nodiscard]] Rgb default_color(std::size_t n);
/// sRGB channel (0..255) to linear light (0..1), IEC 61966-2-1.
[[nodiscard]] float srgb_to_linear(std::uint8_t channel);

}  // namespace splatlas
