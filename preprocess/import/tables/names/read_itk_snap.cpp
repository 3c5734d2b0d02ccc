// ITK-SNAP: label R G B A visible mesh "name".
#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "format/text/ascii_text.h"
#include "preprocess/import/tables/color_text.h"
#include "preprocess/import/tables/names/dialects.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

struct ItkSnapRow {
  std::vector<std::string_view> numbers;  // the label first
  std::string_view name;                  // between the first two quotes
  bool is_open = false;                   // the name has no second quote
};

ItkSnapRow split_row(std::string_view line) {
  const std::size_t open = std::min(line.find('"'), line.size());
  ItkSnapRow row{split_blanks(line.substr(0, open)), line.substr(std::min(open + 1, line.size())), true};
  if (const std::size_t close = row.name.find('"'); close != std::string_view::npos) {
    row.name = row.name.substr(0, close);
    row.is_open = false;
  }
  return row;
}

bool has_seven_numbers(const ItkSnapRow& row) {
  return row.numbers.size() == 7 && std::ranges::all_of(row.numbers, [](std::string_view word) {
           return parse_number(word).has_value();
         });
}

}  // namespace

bool recognise_itk_snap(std::string_view head, std::string_view /*file*/) {
  const std::vector<TextLine> lines = lines_of(head);
  const auto rows = std::ranges::count_if(lines, [](const TextLine& line) {
    return line.text.find('"') != std::string::npos && has_seven_numbers(split_row(line.text));
  });
  return rows > 0 && 2 * static_cast<std::size_t>(rows) > lines.size();
}

Result<void> read_itk_snap(const NamesInput& input, NamesCollector& into) {
  for (const TextLine& line : lines_of(input.text)) {
    const ItkSnapRow row = split_row(line.text);
    if (!has_seven_numbers(row)) {
      into.add_fault(line.number,
                     fmt::format("{} is not: label R G B A visible mesh \"name\"", in_quotes(line.text)));
      continue;
    }
    if (row.is_open) {
      into.add_fault(line.number, fmt::format("{} has no closing quote; add it", in_quotes(row.name)));
      continue;
    }
    LabelName name;
    name.line = line.number;
    name.name = std::string(row.name);
    const auto r = parse_channel(row.numbers[1]);
    const auto g = parse_channel(row.numbers[2]);
    const auto b = parse_channel(row.numbers[3]);
    if (r && g && b) {
      name.color = Rgb{*r, *g, *b};
    } else {
      into.add_bad_color(line.number,
                         fmt::format("{} {} {}", row.numbers[1], row.numbers[2], row.numbers[3]));
    }
    into.add(row.numbers[0], std::move(name));
  }
  return {};
}

}  // namespace splatlas
