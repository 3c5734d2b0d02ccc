// Parsing of colours in tables and in CSS notation.
#pragma once

#include <optional>
#include <string_view>

#include "format/content/color.h"

namespace splatlas {

/// Parses "#rgb", "#rrggbb", "rrggbb" and their forms with alpha, "rgb(1, 2, 3)", "rgba(1, 2, 3, 0.5)", and
/// three or four numbers such as "1,2,3" or "[1, 2, 3]". Ignores alpha. Nullopt for other text and for
/// channels outside 0 to 255.
[[nodiscard]] std::optional<Rgb> parse_table_color(std::string_view text);

/// The same, and the names of CSS level 1 and 2 ("gray", "orange").
[[nodiscard]] std::optional<Rgb> parse_css_color(std::string_view text);

/// A channel from 0 to 255, whole; tables may write 128 as "128.0".
[[nodiscard]] std::optional<std::uint8_t> parse_channel(std::string_view text);

}  // namespace splatlas
