#include "preprocess/import/tables/color_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "format/text/ascii_text.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

/// A name and a colour a line.
constexpr std::string_view kCssColors =
#include "preprocess/import/tables/css_colors.txt"
    ;

std::optional<Rgb> parse_hex(std::string_view digits) {
  if (digits.size() == 4) digits = digits.substr(0, 3);  // with alpha
  if (digits.size() == 8) digits = digits.substr(0, 6);
  const auto color = parse_color(fmt::format("#{}", digits));
  return color ? std::optional(*color) : std::nullopt;
}

/// Three or four numbers with commas or blanks between them, perhaps in brackets; the fourth is alpha.
std::optional<std::array<double, 3>> parse_numbers(std::string_view text) {
  const std::size_t open = text.find_first_of("([");
  if ((open == 0 || text.starts_with("rgb")) && open != std::string_view::npos &&
      (text.ends_with(')') || text.ends_with(']')))
    text = text.substr(open + 1, text.size() - open - 2);
  const std::vector<std::string_view> parts =
      text.find(',') != std::string_view::npos ? split(text, ',') : split_blanks(text);
  if (parts.size() != 3 && parts.size() != 4) return std::nullopt;
  std::array<double, 3> numbers{};
  for (std::size_t n = 0; n < 3; ++n) {
    const auto number = parse_number(parts[n]);
    if (!number) return std::nullopt;
    numbers[n] = *number;
  }
  return numbers;
}

}  // namespace

std::optional<Rgb> parse_table_color(std::string_view text, double scale) {
  const std::string lower = to_lower(trimmed(text));
  if (lower.starts_with('#')) return parse_hex(std::string_view(lower).substr(1));
  const auto numbers = parse_numbers(lower);
  const bool may_be_hex =
      lower.size() == 6 || (lower.size() == 8 && !parse_number(lower));  // else a packed number
  if (!numbers) return may_be_hex ? parse_hex(lower) : std::nullopt;
  // Fractions among whole numbers
  const bool is_fraction = std::ranges::any_of(*numbers, [](double x) { return std::floor(x) != x; });
  if (scale == 1 && is_fraction && std::ranges::max(*numbers) <= 1) return std::nullopt;
  std::array<std::uint8_t, 3> rgb{};
  for (std::size_t n = 0; n < 3; ++n) {
    const double channel = std::round((*numbers)[n] * scale);
    if (!(channel >= 0 && channel <= 255)) return std::nullopt;
    rgb[n] = static_cast<std::uint8_t>(channel);
  }
  return Rgb{rgb[0], rgb[1], rgb[2]};
}

double scale_of_colors(std::span<const std::string> texts) {
  double most = 0;
  for (const std::string& text : texts) {
    if (const auto numbers = parse_numbers(to_lower(trimmed(text))))
      most = std::max(most, std::ranges::max(*numbers));
  }
  return most > 0 && most <= 1.001 ? 255 : 1;  // with rounding errors
}

std::optional<Rgb> parse_css_color(std::string_view text) {
  const std::string lower = to_lower(trimmed(text));
  const std::vector<std::string_view> words = split_blanks(kCssColors);
  const auto named = std::ranges::find(words, lower);
  return parse_table_color(named != words.end() && !lower.starts_with('#') ? named[1] : lower);
}

}  // namespace splatlas
