#include "preprocess/import/tables/table.h"

#include <algorithm>
#include <array>
#include <set>
#include <unordered_map>

#include <fmt/format.h>

#include "format/text/ascii_text.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

/// Role, vocabulary and names of columns, a line each. Names that end with "_" are prefixes: sequences of
/// codes in 3D Slicer's tables, and by their names in DICOM. Of several columns of one role, the name that
/// stands first counts.
constexpr std::string_view kColumns =
#include "preprocess/import/tables/columns.txt"
    ;

struct Alias {
  Column column;
  std::size_t place = 0;  ///< in its line
};

std::string plain_name(std::string_view name) {
  std::string plain = to_lower(trimmed(name.substr(0, name.find('('))));  // "Red (0-255)"
  std::ranges::replace_if(
      plain, [](char c) { return c == ' ' || c == '-' || c == '.' || c == ':'; }, '_');
  return plain;
}

std::unordered_map<std::string, Alias> read_aliases() {
  constexpr std::array<std::string_view, 16> kRoles{"unknown", "unused",  "label", "key",    "name", "color",
                                                    "red",     "green",   "blue",  "parent", "path", "level",
                                                    "code",    "synonym", "term",  "scheme"};
  std::unordered_map<std::string, Alias> aliases;
  for (const std::string_view line : split(kColumns, '\n')) {
    const std::vector<std::string_view> words = split_blanks(line);
    Column column{static_cast<ColumnRole>(std::ranges::find(kRoles, words[0]) - kRoles.begin()),
                  std::string(words[1])};
    if (column.vocabulary == "-") column.vocabulary.clear();
    std::ranges::replace(column.vocabulary, '_', ' ');
    for (std::size_t n = 2; n < words.size(); ++n) aliases.emplace(words[n], Alias{column, n - 2});
  }
  return aliases;
}

/// The alias of a plain name; null for others.
const Alias* find_alias(const std::string& plain) {
  static const std::unordered_map<std::string, Alias> kAliases = read_aliases();
  const auto found = kAliases.find(plain);
  return found == kAliases.end() ? nullptr : &found->second;
}

/// "type_codevalue" and the like.
std::optional<Column> column_of_code(const std::string& plain) {
  const Alias* const sequence = find_alias(plain.substr(0, plain.find('_') + 1));
  if (sequence == nullptr) return std::nullopt;
  const std::string& vocabulary = sequence->column.vocabulary;
  const std::string part = plain.substr(plain.find('_') + 1);
  if (part == "codingscheme" || part == "codingschemedesignator")
    return Column{ColumnRole::kScheme, vocabulary};
  if (part == "codevalue") return Column{ColumnRole::kSchemeCode, vocabulary};
  if (part == "codemeaning") return Column{ColumnRole::kUnused, {}};
  return std::nullopt;
}

/// "name_de": a name in another language.
std::optional<Column> column_of_language(std::string_view plain) {
  for (const std::string_view prefix : {"name_", "label_", "structure_"}) {
    if (!plain.starts_with(prefix)) continue;
    const std::string_view language = plain.substr(prefix.size());
    const bool are_letters = std::ranges::all_of(language, [](char c) { return c >= 'a' && c <= 'z'; });
    if (language.size() == 2 && are_letters && language != "id" && language != "no")
      return Column{ColumnRole::kTerm, std::string(language)};
  }
  return std::nullopt;
}

std::vector<std::string> values_of(const Table& table, std::size_t column) {
  std::vector<std::string> values;
  for (const Table::Row& row : table.rows) {
    if (column < row.fields.size() && !row.fields[column].empty()) values.push_back(row.fields[column]);
  }
  return values;
}

bool is_number(const std::string& text) {
  return parse_number(text).has_value();
}

/// Whole numbers, each once.
bool are_labels(const std::vector<std::string>& values) {
  std::set<std::int64_t> labels;
  return !values.empty() && std::ranges::all_of(values, [&](const std::string& value) {
    const auto label = parse_label(value);
    return label && labels.insert(*label).second;
  });
}

bool are_colors(const std::vector<std::string>& values) {
  return !values.empty() && std::ranges::all_of(values, [](const std::string& value) {
    return !is_number(value) && parse_table_color(value);
  });
}

bool are_texts(const std::vector<std::string>& values) {
  return 2 * std::ranges::count_if(values, is_number) < std::ssize(values);  // a name may be a number
}

/// Gives a role that no column has to the first unknown one whose values fit; of labels, to the only one, or
/// the only one that counts from 1.
void find_by_values(const Table& table, ColumnRole role, bool (*fits)(const std::vector<std::string>& values),
                    std::vector<Column>& columns) {
  if (has_column(columns, role)) return;
  std::vector<std::size_t> found;
  for (std::size_t n = 0; n < columns.size(); ++n) {
    const bool may_be = columns[n].role == ColumnRole::kUnknown ||
                        (role == ColumnRole::kLabel && columns[n].role == ColumnRole::kCode);
    if (may_be && fits(values_of(table, n))) found.push_back(n);
  }
  if (role == ColumnRole::kLabel && found.size() > 1) {
    std::erase_if(found, [&](std::size_t n) {
      const std::vector<std::string> values = values_of(table, n);
      return parse_label(values.front()) != 1 || parse_label(values.back()) != std::ssize(values);
    });
  }
  if (found.size() == 1 || (role != ColumnRole::kLabel && !found.empty()))
    columns[found.front()] = {role, {}};
}

/// Splits a text into records of fields.
class RecordReader {
 public:
  RecordReader(std::string_view text, char separator) : text_(text), separator_(separator) {}

  /// The next record that is neither blank nor a comment. Its fields are empty if a quote has no end.
  std::optional<Table::Row> next() {
    while (at_ < text_.size()) {
      const std::string_view line = rest_of_line();
      if (!trimmed(line).empty() && !is_comment(line)) {
        has_header_ = true;
        return read_record();
      }
      at_ += line.size();
      skip_line_end();
    }
    return std::nullopt;
  }

 private:
  /// Below the header, a line with a separator is a row: its first field may be "#ff0000".
  [[nodiscard]] bool is_comment(std::string_view line) const {
    if (trimmed(line).front() != '#') return false;
    return !has_header_ || line.find(separator_) == std::string_view::npos;
  }

  [[nodiscard]] std::string_view rest_of_line() const {
    return text_.substr(at_, std::min(text_.find_first_of("\r\n", at_), text_.size()) - at_);
  }

  void skip_line_end() {
    if (at_ >= text_.size()) return;
    at_ += text_.substr(at_).starts_with("\r\n") ? 2 : 1;
    ++line_;
  }

  Table::Row read_record() {
    Table::Row row{line_, {}};
    const std::size_t start = at_;
    while (true) {
      const auto field = read_field();
      if (!field) {  // resume behind the line of the open quote
        at_ = start;
        line_ = row.line;
        at_ += rest_of_line().size();
        row.fields.clear();
        break;
      }
      row.fields.push_back(*field);
      if (at_ >= text_.size() || text_[at_] != separator_) break;
      ++at_;
    }
    skip_line_end();
    return row;
  }

  /// A field up to its separator or line end. Nullopt for a quote without an end.
  std::optional<std::string> read_field() {
    while (at_ < text_.size() && text_[at_] == ' ' && separator_ != ' ') ++at_;
    std::string field;
    if (at_ < text_.size() && text_[at_] == '"') {
      ++at_;
      for (;; ++at_) {
        if (at_ >= text_.size()) return std::nullopt;
        if (text_[at_] == '"') {
          if (!text_.substr(at_).starts_with("\"\"")) break;
          ++at_;
        }
        if (text_[at_] == '\n') ++line_;
        field += text_[at_];
      }
      ++at_;
    }
    const std::array<char, 4> ends{separator_, '\r', '\n', '\0'};
    const std::size_t end = std::min(text_.find_first_of(ends.data(), at_), text_.size());
    field += text_.substr(at_, end - at_);
    at_ = end;
    return std::string(trimmed(field));
  }

  std::string_view text_;
  char separator_;
  std::size_t at_ = 0;
  std::size_t line_ = 1;
  bool has_header_ = false;
};

}  // namespace

std::optional<char> find_separator(std::string_view text) {
  const std::vector<TextLine> lines = lines_of(text.substr(0, 64 << 10));
  if (lines.empty()) return std::nullopt;
  std::array<std::pair<char, int>, 3> counts{{{'\t', 0}, {';', 0}, {',', 0}}};
  bool is_quoted = false;
  for (const char c : lines.front().text) {
    if (c == '"') is_quoted = !is_quoted;
    for (auto& [separator, count] : counts) count += c == separator && !is_quoted ? 1 : 0;
  }
  const auto* best = std::ranges::max_element(counts, {}, &std::pair<char, int>::second);
  return best->second > 0 ? std::optional(best->first) : std::nullopt;
}

Table parse_table(std::string_view text, char separator) {
  Table table;
  RecordReader reader(text, separator);
  while (auto row = reader.next()) {
    if (row->fields.empty()) {
      table.faults.push_back({row->line, "a quote has no end; add it"});
      continue;
    }
    if (table.columns.empty()) {
      constexpr std::size_t kMaxColumns = 1000;
      table.columns = std::move(row->fields);
      table.columns.resize(std::min(table.columns.size(), kMaxColumns));
      continue;
    }
    while (row->fields.size() > table.columns.size() && row->fields.back().empty()) row->fields.pop_back();
    if (row->fields.size() > table.columns.size()) {
      table.faults.push_back(
          {row->line,
           fmt::format("has {} fields, the header {}; put a field with '{}' into "
                       "double quotes",
                       row->fields.size(), table.columns.size(), separator == '\t' ? ' ' : separator)});
      continue;
    }
    table.rows.push_back(std::move(*row));
  }
  return table;
}

Column column_of(std::string_view name) {
  const std::string plain = plain_name(name);
  if (const Alias* const alias = find_alias(plain)) return alias->column;
  if (const auto code = column_of_code(plain)) return *code;
  if (const auto language = column_of_language(plain)) return *language;
  const std::string_view level = plain.starts_with("level") ? std::string_view(plain).substr(5) : "";
  if (!level.empty() && level.find_first_not_of("_0123456789") == level.npos) return {ColumnRole::kLevel, {}};
  for (const std::string_view suffix : {"_id", "_code", "id"}) {  // "FMA ID", "snomed_code"
    if (!plain.ends_with(suffix)) continue;
    const Alias* const alias = find_alias(plain.substr(0, plain.size() - suffix.size()));
    if (alias != nullptr && alias->column.role == ColumnRole::kTerm) return alias->column;
  }
  constexpr std::string_view kTermPrefix = "term ";  // "term 99XYZ": any other vocabulary
  if (to_lower(name).starts_with(kTermPrefix))
    return {ColumnRole::kTerm, std::string(name.substr(kTermPrefix.size()))};
  return {};
}

std::size_t find_column(std::span<const Column> columns, ColumnRole role) {
  const auto found = std::ranges::find(columns, role, &Column::role);
  return found == columns.end() ? std::string::npos : static_cast<std::size_t>(found - columns.begin());
}

std::vector<Column> columns_of(const Table& table) {
  std::vector<Column> columns;
  for (const std::string& name : table.columns) columns.push_back(column_of(name));
  if (!has_column(columns, ColumnRole::kName)) {  // "index,label": the label is a name
    for (std::size_t n = 0; n < columns.size(); ++n) {
      if (columns[n].role == ColumnRole::kLabel && are_texts(values_of(table, n)))
        columns[n].role = ColumnRole::kName;
    }
  }
  // One column for each role: the alias that stands first in the list.
  for (int role = static_cast<int>(ColumnRole::kLabel); role <= static_cast<int>(ColumnRole::kPath); ++role) {
    std::size_t best = std::string::npos;
    const auto rank = [&](std::size_t n) {
      const Alias* const alias = find_alias(plain_name(table.columns[n]));
      return alias == nullptr ? ~std::size_t{0} : alias->place;
    };
    for (std::size_t n = 0; n < columns.size(); ++n) {
      if (static_cast<int>(columns[n].role) != role) continue;
      if (best == std::string::npos || rank(n) < rank(best)) best = n;
    }
    for (std::size_t n = 0; n < columns.size(); ++n) {
      if (static_cast<int>(columns[n].role) == role && n != best) columns[n].role = ColumnRole::kUnknown;
    }
  }
  const bool has_key = has_column(columns, ColumnRole::kKey);
  const std::size_t name = find_column(columns, ColumnRole::kName);
  const bool has_label = has_column(columns, ColumnRole::kLabel);
  bool has_text = false;
  for (std::size_t n = 0; n < columns.size(); ++n)
    has_text = has_text || (columns[n].role == ColumnRole::kUnknown && are_texts(values_of(table, n)));
  if (!has_label && !has_key && has_text && name != std::string::npos && are_labels(values_of(table, name)))
    columns[name].role = ColumnRole::kUnknown;
  if (!has_column(columns, ColumnRole::kRed)) find_by_values(table, ColumnRole::kColor, are_colors, columns);
  find_by_values(table, ColumnRole::kName, are_texts, columns);
  if (has_column(columns, ColumnRole::kName) && !has_key)
    find_by_values(table, ColumnRole::kLabel, are_labels, columns);
  return columns;
}

void add_header(Table& table) {
  table.rows.insert(table.rows.begin(), {1, table.columns});
  const std::size_t count = table.columns.size();
  std::vector<std::string> names(count);
  const auto claim = [&](const char* name, bool (*fits)(const std::vector<std::string>&)) {
    for (std::size_t n = 0; n < count; ++n) {
      if (!names[n].empty() || !fits(values_of(table, n))) continue;
      names[n] = name;
      return;
    }
  };
  names[parse_label(table.rows[0].fields[0]) ? 0 : count - 1] = "label";
  claim("color", are_colors);
  claim("name", are_texts);
  const auto are_numbers = [&](std::size_t n) {
    return names[n].empty() && std::ranges::all_of(values_of(table, n), is_number);
  };
  for (std::size_t n = 0; n + 2 < count; ++n) {
    if (!are_numbers(n) || !are_numbers(n + 1) || !are_numbers(n + 2)) continue;
    names[n] = "r", names[n + 1] = "g", names[n + 2] = "b";
    if (n + 3 < count && are_numbers(n + 3)) names[n + 3] = "a";
    break;
  }
  claim("code", [](const std::vector<std::string>& values) {
    return std::ranges::all_of(values,
                               [](const std::string& value) { return parse_integer(value).has_value(); });
  });
  for (std::size_t n = 0; n < count; ++n)
    table.columns[n] = names[n].empty() ? fmt::format("column {}", n + 1) : names[n];
}

}  // namespace splatlas
