// Names in lists: a label, a name and perhaps a colour a line, with blanks between them.
#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "format/text/ascii_text.h"
#include "preprocess/import/tables/names_collector.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

/// A line that begins with a whole number. The parts refer to the text.
struct ListRow {
  std::size_t line = 0;
  std::string_view text, label;
  std::vector<std::string_view> words;  ///< behind the label; text in double quotes is one word
  bool is_open = false;                 ///< a quote has no end
  /// Numbers ahead of the name and behind it. The name has one word at least.
  std::size_t numbers_first = 0, numbers_last = 0;
};

/// The place and number of the colour channels in most rows of a list.
struct ListShape {
  enum class Colors { kNone, kFirst, kLast } colors = Colors::kNone;
  std::size_t numbers = 0;     ///< R G B, and A or further ones
  bool leaves_number = false;  ///< to the name: "T 1 0.8 0.2 0.1"
  bool is_doubtful = false;    ///< it may be of the name or red
};

bool is_finite_number(std::string_view word) {
  const auto number = parse_number(word);
  return number && std::isfinite(*number);
}

/// A field between tabs behind the label is one word.
std::vector<std::string_view> split_words(std::string_view line, bool& is_open) {
  std::vector<std::string_view> words;
  if (line.starts_with('\t') && trimmed(line).front() != '"') {
    line.remove_prefix(1);
    const std::size_t end = std::min(line.find('\t'), line.size());
    if (const std::string_view field = trimmed(line.substr(0, end)); !field.empty()) words.push_back(field);
    line.remove_prefix(end);
  }
  for (line = trimmed(line); !line.empty(); line = trimmed(line)) {
    const std::size_t close = line.front() == '"' ? line.find('"', 1) : std::string_view::npos;
    is_open = is_open || (line.front() == '"' && close == std::string_view::npos);
    const std::size_t end =
        close != std::string_view::npos ? close + 1 : std::min(line.find_first_of(" \t"), line.size());
    words.push_back(line.substr(0, end));
    line.remove_prefix(end);
  }
  return words;
}

/// Nullopt for a line that does not begin with a whole number, perhaps with ":" or "=" behind it.
std::optional<ListRow> row_of(const TextLine& line) {
  ListRow row{.line = line.number, .text = line.text, .label = line.text, .words = {}};
  row.text = trimmed(row.text.substr(0, row.text.find(" # ")));  // a comment
  row.label = row.text.substr(0, row.text.find_first_of(" \t:="));
  const auto label = parse_number(row.label);
  if (!label || std::floor(*label) != *label) return std::nullopt;
  std::string_view rest = row.text.substr(row.label.size());
  if (const std::string_view behind = trimmed(rest); behind.starts_with(':') || behind.starts_with('='))
    rest = behind.substr(1);
  row.words = split_words(rest, row.is_open);
  if (row.words.empty()) return row;
  const auto first = std::find_if_not(row.words.begin(), row.words.end() - 1, is_finite_number);
  const auto last = std::find_if_not(row.words.rbegin(), row.words.rend() - 1, is_finite_number);
  row.numbers_first = static_cast<std::size_t>(first - row.words.begin());
  row.numbers_last = static_cast<std::size_t>(last - row.words.rbegin());
  const auto name = parse_number(row.words.front());
  if (name && std::floor(*name) != *name) row.numbers_last = 0;  // a fraction is no name
  return row;
}

/// The lines of a list. In Connectome Workbench's, a name stands ahead of "label R G B A": it moves behind.
std::vector<TextLine> list_lines(std::string_view text) {
  std::vector<TextLine> lines = lines_of(text), joined;
  for (std::size_t n = 1; n < lines.size(); n += 2) {
    const auto row = row_of(lines[n]);
    if (row_of(lines[n - 1]) || !row || row->words.size() != 4 || row->numbers_first != 3) return lines;
    joined.push_back({lines[n].number, lines[n].text + " " + lines[n - 1].text});
  }
  return joined.size() > 1 ? joined : lines;
}

std::vector<ListRow> rows_of(const std::vector<TextLine>& lines) {
  std::vector<ListRow> rows;
  for (const TextLine& line : lines)
    if (auto row = row_of(line)) rows.push_back(std::move(*row));
  return rows;
}

/// True if a column of numbers can be opacity: all equal, mostly 0, 1 or 255, or fractions.
bool are_alphas(const std::vector<double>& values) {
  const auto [least, most] = std::ranges::minmax(values);
  const auto full = std::ranges::count_if(values, [](double a) { return a == 0 || a == 1 || a == 255; });
  return least == most || (least >= 0 && most <= 1) || 2 * full > std::ssize(values);
}

/// Leaves the first of the numbers behind the name to it, if it is whole in all rows and numbers from 0 to 1
/// follow. It is no red if it exceeds 1, or if the names would be equal without it. It is red if the last is
/// an opacity, as 1 is. Whole numbers alone leave a doubt, unless that opacity is 1.
void leave_number(std::span<const ListRow* const> rows, const std::vector<double>& alphas, ListShape& shape) {
  std::set<std::string_view> names;
  double most = 0, most_behind = 0;
  bool has_fractions = false;
  for (const ListRow* row : rows) {
    const auto numbers = std::span(row->words).last(shape.numbers);
    const auto first = parse_integer(numbers[0]);
    if (!first || row->words[row->words.size() - shape.numbers - 1].ends_with('"')) return;
    const char* const name = row->words[0].data();
    names.insert(trimmed({name, static_cast<std::size_t>(numbers[0].data() - name)}));
    most = std::max(most, static_cast<double>(*first));
    for (const std::string_view channel : numbers.subspan(1, 3)) {
      most_behind = std::max(most_behind, parse_number(channel).value_or(0));
      has_fractions = has_fractions || !parse_integer(channel);
    }
  }
  const bool are_equal = names.size() < rows.size();
  if (!(most_behind > 0 && most_behind <= 1)) return;
  const auto [least, greatest] = std::ranges::minmax(alphas);
  const bool are_whole = !has_fractions && !are_equal;
  const bool is_opacity = std::ranges::none_of(alphas, [](double a) { return std::floor(a) != a; }) ||
                          (alphas.size() > 1 && least == greatest);
  const bool is_red = most > 1 ? are_whole && least == 1 && rows.size() > 1 : is_opacity;
  shape.is_doubtful = most > 1 || is_red ? are_whole && (most > 1 || least < 1) : !are_equal;
  if (is_red) return;
  --shape.numbers;
  shape.leaves_number = true;
}

/// The shape with colours at `place`: R G B, A, type behind the name; R G B, A, visible and mesh ahead of it.
/// All rows with three numbers have them, and the fourth is an opacity; what is left of them belongs to the
/// name. No numbers unless most rows have three, or `some`.
ListShape shape_at(ListShape::Colors place, std::span<const ListRow> rows, bool some) {
  const bool is_last = place == ListShape::Colors::kLast;
  std::vector<const ListRow*> colored;
  std::size_t least = ~std::size_t{0}, without = 0, opaque = 0;
  for (const ListRow& row : rows) {
    const std::size_t numbers = is_last ? row.numbers_last : row.numbers_first;
    if (numbers < 3) continue;
    colored.push_back(&row);
    least = std::min(least, numbers);
    without += numbers == 3 ? 1 : 0;
    opaque += numbers > 3 && row.words.back() == "255" ? 1 : 0;
  }
  if (colored.empty() || (!some && 2 * colored.size() <= rows.size())) return {place, 0};
  for (const std::size_t numbers : is_last ? std::array{5u, 4u} : std::array{6u, 4u}) {
    std::vector<double> alphas;
    for (const ListRow* row : colored)
      if (numbers <= least)
        alphas.push_back(
            parse_number(row->words[is_last ? row->words.size() - numbers + 3 : 3]).value_or(-1));
    if (alphas.empty() || !are_alphas(alphas)) continue;
    ListShape shape{place, numbers};
    if (is_last) leave_number(colored, alphas, shape);
    return shape;
  }
  const bool is_doubtful = is_last && without > 0 && opaque > 0 && without + opaque == colored.size();
  return {place, 3, is_doubtful, is_doubtful};
}

ListShape shape_of(std::span<const ListRow> rows) {
  for (const auto place : {ListShape::Colors::kLast, ListShape::Colors::kFirst})
    if (const ListShape shape = shape_at(place, rows, false); shape.numbers > 0) return shape;
  return {};
}

ListShape shape_of_head(std::string_view head) {
  return shape_of(rows_of(list_lines(head)));
}

std::string_view unquoted(std::string_view text) {
  const bool is_quoted =
      text.size() > 1 && text.front() == text.back() && (text.front() == '"' || text.front() == '\'');
  return is_quoted ? text.substr(1, text.size() - 2) : text;
}

/// The text of a row from a word on. A name in quotes ends with them.
std::string_view text_from(const ListRow& row, std::size_t word) {
  const std::string_view first = row.words[word];
  if (first.front() == '"' && first.size() > 1 && first.back() == '"') return unquoted(first);
  return trimmed(row.text.substr(static_cast<std::size_t>(first.data() - row.text.data())));
}

/// The channels of a row that has its colour where the list has it; else none.
std::span<const std::string_view> channels_of(const ListRow& row, const ListShape& shape) {
  const std::span words(row.words);
  if (shape.colors == ListShape::Colors::kFirst)
    return row.numbers_first >= shape.numbers ? words.first(shape.numbers) : words.first(0);
  const bool has_type = shape.numbers == 4 && !shape.leaves_number && row.numbers_last == 5 &&
                        words.size() == 6 && words.back() != "0" && words[4] == "0";  // FreeSurfer's
  const std::size_t count = shape.numbers + (has_type ? 1 : 0);
  return row.numbers_last >= shape.numbers ? words.last(count) : words.first(0);
}

/// Reads rows with colours. Lines without a label are comments where colours stand last, as 3D Slicer and
/// FreeSurfer take them. With `underscores_are_blanks`, "_" in a name is a blank. kFailed, with the first
/// line and `layout`, if no row has colours there.
Result<void> read_color_rows(const NamesInput& input, ListShape::Colors place, const char* layout,
                             bool underscores_are_blanks, NamesCollector& into) {
  const bool are_last = place == ListShape::Colors::kLast;
  const std::vector<TextLine> lines = list_lines(input.text);
  const std::vector<ListRow> rows = rows_of(lines);
  const ListShape shape = shape_at(place, rows, true);
  if (shape.numbers == 0 && !lines.empty()) {
    return input.refuse(fmt::format("line {}: {} is not: {}; correct it, or give another --names-format",
                                    lines.front().number, in_quotes(lines.front().text), layout));
  }
  if (shape.is_doubtful)
    into.add_note(shape.leaves_number ? "names-or-red" : "red-or-names", rows[0].line, rows[0].text);
  std::vector<std::string> colors;
  for (const ListRow& row : rows) {
    const auto channels = channels_of(row, shape);
    colors.push_back(channels.empty() ? "" : fmt::format("{}", fmt::join(channels.first(3), " ")));
  }
  const double scale = scale_of_colors(colors);
  auto row = rows.begin();
  for (const TextLine& line : lines) {
    if (row == rows.end() || row->line != line.number) {
      if (!are_last) into.add_fault(line.number, fmt::format("{} is not: {}", in_quotes(line.text), layout));
      continue;
    }
    const std::string& color = colors[static_cast<std::size_t>(row - rows.begin())];
    const ListRow& one = *row++;
    const std::size_t channels = channels_of(one, shape).size();
    LabelName name;
    name.line = line.number;
    name.color = parse_table_color(color, scale);
    if (!name.color) into.add_note("bad-colors", line.number, color.empty() ? line.text : color);
    if (are_last) {
      const std::size_t words =
          channels > 0 ? one.words.size() - channels : std::min<std::size_t>(1, one.words.size());
      name.name = unquoted(fmt::format("{}", fmt::join(std::span(one.words).first(words), " ")));
    } else if (channels == 0 || one.is_open) {
      into.add_fault(line.number, one.is_open
                                      ? fmt::format("{} has no closing quote; add it", in_quotes(line.text))
                                      : fmt::format("{} is not: {}", in_quotes(line.text), layout));
      continue;
    } else {
      name.name = text_from(one, channels);
    }
    if (underscores_are_blanks) std::ranges::replace(name.name, '_', ' ');
    into.add(one.label, std::move(name));
  }
  return {};
}

// 3D Slicer's colour tables.
constexpr std::string_view kTable = "# Color table file", kRamp = "# Color procedural file";
constexpr const char* kColorsLast = "label name R G B A";

/// A name without channels. A number behind it may be the code, "#ff8800" or "rgb(1, 2, 3)" the colour.
LabelName name_of(const ListRow& row, bool has_code) {
  LabelName name;
  name.line = row.line;
  if (row.words.empty()) return name;
  std::string_view text =
      row.text.substr(static_cast<std::size_t>(row.words.front().data() - row.text.data()));
  const std::string_view first = row.words.front(), last = row.words.back();
  const std::size_t bracket = std::min(text.rfind(" rgb"), text.rfind(" ("));
  constexpr std::size_t kLeast = 7;  // "#101" is a number
  const std::string_view color = last.starts_with('#') && last.size() >= kLeast     ? last
                                 : first.starts_with('#') && first.size() >= kLeast ? first
                                 : text.ends_with(')') && bracket != std::string_view::npos
                                     ? text.substr(bracket)
                                     : "";
  if (has_code && row.words.size() > 1 && row.numbers_last == 1 && (name.code = parse_integer(last))) {
    text.remove_suffix(last.size());
  } else if (row.words.size() > 1 && (name.color = parse_table_color(color))) {
    text = color == first ? text.substr(first.size()) : text.substr(0, text.size() - color.size());
  }
  name.name = unquoted(trimmed(text));
  return name;
}

// FreeSurfer's colour tables, also those of FastSurfer with a header line: id name R G B A [type].
// A is transparency, and a few tables hide structures by it. All are shown opaque here.

bool recognise_freesurfer(std::string_view head) {
  const std::vector<TextLine> lines = list_lines(head);
  const std::vector<ListRow> rows = rows_of(lines);
  const ListShape shape = shape_of(rows);
  if (shape.colors != ListShape::Colors::kLast || head.starts_with(kTable)) return false;
  const auto zeros = std::ranges::count_if(rows, [&](const ListRow& row) {
    const auto channels = channels_of(row, shape);
    return channels.size() > 3 && channels[3] == "0";
  });
  return 2 * static_cast<std::size_t>(zeros) > rows.size() ||
         lines.front().text.starts_with("ID\tLabelName") ||
         head.find("#No. Label Name") != std::string_view::npos;
}

Result<void> read_ctbl(const NamesInput& input, NamesCollector& into) {
  if (input.text.starts_with(kRamp)) {
    return input.refuse("line 1: is a colour ramp (\"Color procedural file\"), which names no labels");
  }
  return read_color_rows(input, ListShape::Colors::kLast, kColorsLast, true, into);
}

// Lists of MRIcron, AAL and most others: label name [code]. Names that would be equal end in a number.
Result<void> read_mricron(const NamesInput& input, NamesCollector& into) {
  const std::vector<TextLine> lines = lines_of(input.text);
  std::set<std::string> names;
  const bool have_codes = std::ranges::all_of(rows_of(lines), [&](const ListRow& row) {
    const LabelName name = name_of(row, true);
    return !name.code || names.insert(name_key(name.name)).second;
  });
  for (const TextLine& line : lines) {
    const auto row = row_of(line);
    if (!row) {
      into.add(split_blanks(line.text).front(), LabelName{{}, line.number, {}});
    } else if (row->is_open && parse_label(row->label) != 0) {
      into.add_fault(line.number, fmt::format("{} has no closing quote; add it", in_quotes(line.text)));
    } else if (row->numbers_last > 3 || row->numbers_first > 2) {
      into.add_fault(line.number,
                     fmt::format("{} has a colour; it is a row of a colour table", in_quotes(line.text)));
    } else {
      into.add(row->label, name_of(*row, have_codes));
    }
  }
  return {};
}

}  // namespace

const Dialect kItkSnapNames{{NamesFormat::kItkSnap, "itksnap", "ITK-SNAP labels"},
                            [](std::string_view head) {
                              const ListShape shape = shape_of_head(head);
                              return shape.colors == ListShape::Colors::kFirst && shape.numbers >= 6;
                            },
                            [](const NamesInput& input, NamesCollector& into) {
                              return read_color_rows(input, ListShape::Colors::kFirst,
                                                     "label R G B A visible mesh \"name\"", false, into);
                            }};
const Dialect kFslEyesNames{
    {NamesFormat::kFslEyes, "fsleyes", "FSLeyes colour table"},
    [](std::string_view head) { return shape_of_head(head).colors == ListShape::Colors::kFirst; },
    [](const NamesInput& input, NamesCollector& into) {
      return read_color_rows(input, ListShape::Colors::kFirst, "label R G B name", false, into);
    }};
const Dialect kFreeSurferNames{{NamesFormat::kFreeSurfer, "freesurfer", "FreeSurfer colour table"},
                               recognise_freesurfer,
                               [](const NamesInput& input, NamesCollector& into) {
                                 return read_color_rows(input, ListShape::Colors::kLast, kColorsLast, false,
                                                        into);
                               }};
const Dialect kCtblNames{{NamesFormat::kCtbl, "ctbl", "3D Slicer colour table"},
                         [](std::string_view head) {
                           return head.starts_with(kTable) || head.starts_with(kRamp) ||
                                  shape_of_head(head).colors == ListShape::Colors::kLast;
                         },
                         read_ctbl};
const Dialect kMricronNames{{NamesFormat::kMricron, "mricron", "list of labels and names"},
                            [](std::string_view head) {
                              const std::vector<TextLine> lines = lines_of(head);
                              return !lines.empty() && row_of(lines.front());
                            },
                            read_mricron};

}  // namespace splatlas
