// Names in lists: a label, a name and perhaps a colour a line.
#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "format/text/ascii_text.h"
#include "preprocess/import/tables/color_text.h"
#include "preprocess/import/tables/names/dialects.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

// Rows "label name R G B A" of the colour tables of 3D Slicer and FreeSurfer.

/// A row, split at blanks. The parts refer to the line.
struct ColorRow {
  std::string_view label;
  std::string name;                      ///< words joined by one blank
  std::vector<std::string_view> colors;  ///< R G B, and A if given
};

/// Statistics of the rows of a head: whether most lines are such rows, and the meaning of their last column.
struct ColorRowsOfHead {
  bool are_most = false;
  bool are_transparencies = false;  ///< FreeSurfer: A is mostly 0, which is opaque there
};

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

/// Splits "label name R G B [A [type]]". Nullopt unless the label is whole and the last words are colours.
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
  std::size_t rows = 0, zeros = 0;
  for (const TextLine& line : lines) {
    const auto row = split_color_row(line.text);
    if (!row) continue;
    ++rows;
    if (row->colors.size() > 3 && row->colors[3] == "0") ++zeros;
  }
  return {2 * rows > lines.size(), 2 * zeros > rows};
}

/// Sets the colour that R, G and B are.
void set_color(std::span<const std::string_view> rgb, LabelName& name, NamesCollector& into) {
  const auto r = parse_channel(rgb[0]), g = parse_channel(rgb[1]), b = parse_channel(rgb[2]);
  if (r && g && b) {
    name.color = Rgb{*r, *g, *b};
  } else {
    into.add_bad_color(name.line, fmt::format("{} {} {}", rgb[0], rgb[1], rgb[2]));
  }
}

/// Adds all rows. Lines that do not begin with a whole number are comments, as both programs take them. With
/// `underscores_are_blanks`, "_" in a name is a blank. kFailed, with the first line, if none has colours.
Result<void> add_color_rows(const NamesInput& input, bool underscores_are_blanks, NamesCollector& into) {
  const std::vector<TextLine> lines = lines_of(input.text);
  bool is_table = lines.empty();
  for (const TextLine& line : lines) {
    const std::vector<std::string_view> words = split_blanks(line.text);
    if (!is_whole(words.front())) continue;
    const auto row = split_color_row(line.text);
    is_table = is_table || row;
    LabelName name;
    name.line = line.number;
    if (!row) {
      name.name = words.size() > 1 ? std::string(words[1]) : "";
      into.add_bad_color(line.number, line.text);
    } else {
      name.name = row->name;
      set_color(row->colors, name, into);
    }
    if (underscores_are_blanks) std::ranges::replace(name.name, '_', ' ');
    into.add(words.front(), std::move(name));
  }
  if (is_table) return {};
  return input.refuse(
      fmt::format("line {}: {} is not: label name R G B A; correct it, or give another --names-format",
                  lines.front().number, in_quotes(lines.front().text)));
}

// ITK-SNAP: label R G B A visible mesh "name".

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

// 3D Slicer's colour tables.
constexpr std::string_view kTable = "# Color table file", kRamp = "# Color procedural file";

// Lists of MRIcron, AAL and most others: label name [code].

/// Words of a line. Text in double quotes is one word, without the quotes.
struct Words {
  std::vector<std::string_view> all;
  bool last_is_quoted = false;
  std::string_view unclosed;  ///< the text from a quote without an end
};

Words split_words(std::string_view line) {
  Words words;
  for (line = trimmed(line); !line.empty(); line = trimmed(line)) {
    const bool opens = line.front() == '"';
    const bool is_quoted = opens && line.find('"', 1) != std::string_view::npos;
    if (opens && !is_quoted) words.unclosed = line;
    const std::size_t end = is_quoted ? line.find('"', 1) : std::min(line.find_first_of(" \t"), line.size());
    words.all.push_back(is_quoted ? line.substr(1, end - 1) : line.substr(0, end));
    words.last_is_quoted = is_quoted;
    line.remove_prefix(is_quoted ? end + 1 : end);
  }
  return words;
}

/// Parses what follows the label: a number after the name is the code.
LabelName parse_name(std::string_view rest, const Words& words) {
  LabelName result;
  const std::optional<std::int64_t> number = parse_integer(words.all.back());
  if (words.all.size() > 2 && !words.last_is_quoted && number) {
    result.code = number;
    rest = trimmed(rest.substr(0, rest.find_last_of(" \t")));
  }
  if (rest.size() > 1 && rest.front() == '"' && rest.back() == '"') rest = rest.substr(1, rest.size() - 2);
  result.name = std::string(trimmed(rest));
  return result;
}

}  // namespace

bool recognise_itk_snap(std::string_view head) {
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
    set_color(std::span(row.numbers).subspan(1), name, into);
    into.add(row.numbers[0], std::move(name));
  }
  return {};
}

// FreeSurfer's colour tables, also those of FastSurfer with a header line: id name R G B A [type].
// A is transparency, and a few tables hide structures by it. All are shown opaque here.

bool recognise_freesurfer(std::string_view head) {
  if (head.starts_with(kTable)) return false;
  const ColorRowsOfHead rows = inspect_color_rows(head);
  if (!rows.are_most) return false;
  if (head.find("#No. Label Name") != std::string_view::npos || rows.are_transparencies) return true;
  const std::vector<TextLine> lines = lines_of(head);
  const std::vector<std::string_view> first = split_blanks(lines.front().text);
  return first.size() > 1 && first[0] == "ID" && first[1] == "LabelName";
}

Result<void> read_freesurfer(const NamesInput& input, NamesCollector& into) {
  return add_color_rows(input, false, into);
}

bool recognise_ctbl(std::string_view head) {
  return head.starts_with(kTable) || head.starts_with(kRamp) || inspect_color_rows(head).are_most;
}

Result<void> read_ctbl(const NamesInput& input, NamesCollector& into) {
  if (input.text.starts_with(kRamp)) {
    return input.refuse("line 1: is a colour ramp (\"Color procedural file\"), which names no labels");
  }
  return add_color_rows(input, true, into);
}

bool recognise_mricron(std::string_view head) {
  const std::vector<TextLine> lines = lines_of(head);
  return !lines.empty() && parse_integer(split_blanks(lines.front().text).front());
}

Result<void> read_mricron(const NamesInput& input, NamesCollector& into) {
  for (const TextLine& line : lines_of(input.text)) {
    const std::string_view text = line.text;
    const std::string_view label = split_blanks(text).front();
    const Words words = split_words(text);
    if (!words.unclosed.empty() && parse_label(label) != 0) {
      into.add_fault(line.number, fmt::format("{} has no closing quote; add it", in_quotes(words.unclosed)));
      continue;
    }
    if (const auto row = split_color_row(text); row && row->colors.size() > 3) {
      into.add_fault(line.number,
                     fmt::format("{} has a colour; it is a row of a colour table", in_quotes(text)));
      continue;
    }
    LabelName name;
    if (words.all.size() > 1) name = parse_name(trimmed(text.substr(label.size())), words);
    name.line = line.number;
    into.add(label, std::move(name));
  }
  return {};
}

}  // namespace splatlas
