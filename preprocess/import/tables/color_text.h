// Parsing of colours in tables and in CSS notation.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "format/content/color.h"

namespace splatlas {

/// Parses "#rgb", "#rrggbb", "rrggbb" and their forms with alpha, "rgb(1, 2, 3)", "rgba(1, 2, 3, 0.5)", and
/// three or four numbers such as "1,2,3" or "[1, 2, 3]", which `scale` multiplies. Rounds to whole channels
/// and ignores alpha. Nullopt for other text and for channels outside 0 to 255.
[[nodiscard]] std::optional<Rgb> parse_table_color(std::string_view text, double scale = 1);

/// The scale of the numbers of a column of colours: 255 if none is above 1 and one is above 0, else 1.
[[nodiscard]] double scale_of_colors(std::span<const std::string> texts);

/// The same, and the names of CSS level 1 and 2 ("gray", "orange").
[[nodiscard]] std::optional<Rgb> parse_css_color(std::string_view text);

}  // namespace splatlas
