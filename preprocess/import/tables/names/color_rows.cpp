#include "preprocess/import/tables/names/color_rows.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "format/text/ascii_text.h"
#include "preprocess/import/tables/color_text.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

bool is_whole(std::string_view word) {
  return parse_integer(word).has_value();
}

/// The number of words of the name: what is left of the colours.
std::size_t count_name_words(const std::vector<std::string_view>& words) {
  const auto numbers =
      static_cast<std::size_t>(std::find_if_not(words.rbegin(), words.rend() - 1, is_whole) - words.rbegin());
  if (words.size() == 5 && numbers >= 3) return 1;                  // without A
  if (words.size() == 7 && numbers >= 5) return 1;                  // with a type
  return words.size() >= 6 && numbers >= 4 ? words.size() - 5 : 0;  // names may be numbers
}

}  // namespace

std::optional<ColorRow> split_color_row(std::string_view line) {
  const std::vector<std::string_view> words = split_blanks(line);
  if (words.empty() || !is_whole(words.front())) return std::nullopt;
  const std::size_t count = count_name_words(words);
  if (count == 0) return std::nullopt;
  const std::span rest = std::span(words).subspan(1 + count);
  return ColorRow{words.front(),
                  fmt::format("{}", fmt::join(std::span(words).subspan(1, count), " ")),
                  {rest.begin(), rest.end()}};
}

ColorRowsOfHead inspect_color_rows(std::string_view head) {
  const std::vector<TextLine> lines = lines_of(head);
  std::size_t rows = 0;
  std::size_t zeros = 0;
  for (const TextLine& line : lines) {
    const auto row = split_color_row(line.text);
    if (!row) continue;
    ++rows;
    if (row->colors.size() > 3 && row->colors[3] == "0") ++zeros;
  }
  return {2 * rows > lines.size(), 2 * zeros > rows};
}

void add_color_rows(const NamesInput& input, bool underscores_are_blanks, NamesCollector& into) {
  for (const TextLine& line : lines_of(input.text)) {
    const std::vector<std::string_view> words = split_blanks(line.text);
    if (!is_whole(words.front())) continue;
    const auto row = split_color_row(line.text);
    LabelName name;
    name.line = line.number;
    if (!row) {
      name.name = words.size() > 1 ? std::string(words[1]) : "";
      into.add_bad_color(line.number, line.text);
    } else {
      name.name = row->name;
      const auto r = parse_channel(row->colors[0]);
      const auto g = parse_channel(row->colors[1]);
      const auto b = parse_channel(row->colors[2]);
      if (r && g && b) {
        name.color = Rgb{*r, *g, *b};
      } else {
        into.add_bad_color(line.number,
                           fmt::format("{} {} {}", row->colors[0], row->colors[1], row->colors[2]));
      }
    }
    if (underscores_are_blanks) std::ranges::replace(name.name, '_', ' ');
    into.add(words.front(), std::move(name));
  }
}

}  // namespace splatlas
