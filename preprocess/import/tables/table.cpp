#include "preprocess/import/tables/table.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "format/text/ascii_text.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

struct Alias {
  const char* name;
  ColumnRole role;
  const char* vocabulary = "";
};

/// Of several columns of one role, the alias that stands first counts.
constexpr Alias kAliases[] = {
    {"labelvalue", ColumnRole::kLabel},
    {"label_value", ColumnRole::kLabel},
    {"label", ColumnRole::kLabel},
    {"labels", ColumnRole::kLabel},
    {"index", ColumnRole::kLabel},
    {"idx", ColumnRole::kLabel},
    {"value", ColumnRole::kLabel},
    {"label_id", ColumnRole::kLabel},
    {"labelid", ColumnRole::kLabel},
    {"label_number", ColumnRole::kLabel},
    {"number", ColumnRole::kLabel},
    {"class", ColumnRole::kLabel},
    {"class_id", ColumnRole::kLabel},
    {"no", ColumnRole::kLabel},
    {"nr", ColumnRole::kLabel},
    {"id", ColumnRole::kKey},
    {"key", ColumnRole::kKey},
    {"structure_id", ColumnRole::kKey},
    {"region_id", ColumnRole::kKey},
    {"roi_id", ColumnRole::kKey},
    {"name", ColumnRole::kName},
    {"structure", ColumnRole::kName},
    {"region", ColumnRole::kName},
    {"labelname", ColumnRole::kName},
    {"label_name", ColumnRole::kName},
    {"structure_name", ColumnRole::kName},
    {"region_name", ColumnRole::kName},
    {"roi", ColumnRole::kName},
    {"roi_name", ColumnRole::kName},
    {"class_name", ColumnRole::kName},
    {"full_name", ColumnRole::kName},
    {"totalsegmentator_name", ColumnRole::kName},
    {"color", ColumnRole::kColor},
    {"colour", ColumnRole::kColor},
    {"hex", ColumnRole::kColor},
    {"rgb", ColumnRole::kColor},
    {"rgba", ColumnRole::kColor},
    {"color_hex", ColumnRole::kColor},
    {"hex_color", ColumnRole::kColor},
    {"color_hex_triplet", ColumnRole::kColor},
    {"rgb_triplet", ColumnRole::kColor},
    {"dicomrgbcolor", ColumnRole::kColor},
    {"r", ColumnRole::kRed},
    {"red", ColumnRole::kRed},
    {"color_r", ColumnRole::kRed},
    {"g", ColumnRole::kGreen},
    {"green", ColumnRole::kGreen},
    {"color_g", ColumnRole::kGreen},
    {"b", ColumnRole::kBlue},
    {"blue", ColumnRole::kBlue},
    {"color_b", ColumnRole::kBlue},
    {"parent", ColumnRole::kParent},
    {"parent_id", ColumnRole::kParent},
    {"parent_structure_id", ColumnRole::kParent},
    {"parent_name", ColumnRole::kParent},
    {"parent_label", ColumnRole::kParent},
    {"path", ColumnRole::kPath},
    {"structure_id_path", ColumnRole::kPath},
    {"hierarchy", ColumnRole::kPath},
    {"synonym", ColumnRole::kSynonym},
    {"synonyms", ColumnRole::kSynonym},
    {"alias", ColumnRole::kSynonym},
    {"aliases", ColumnRole::kSynonym},
    {"alternative_name", ColumnRole::kSynonym},
    {"abbreviation", ColumnRole::kTerm, "abbreviation"},
    {"abbr", ColumnRole::kTerm, "abbreviation"},
    {"acronym", ColumnRole::kTerm, "abbreviation"},
    {"latin", ColumnRole::kTerm, "la"},
    {"snomed", ColumnRole::kTerm, "SNOMED"},
    {"snomedct", ColumnRole::kTerm, "SNOMED"},
    {"snomed_ct", ColumnRole::kTerm, "SNOMED"},
    {"sct", ColumnRole::kTerm, "SNOMED"},
    {"fma", ColumnRole::kTerm, "FMA"},
    {"radlex", ColumnRole::kTerm, "RadLex"},
    {"rid", ColumnRole::kTerm, "RadLex"},
    {"ta2", ColumnRole::kTerm, "TA2"},
    {"ta98", ColumnRole::kTerm, "TA98"},
    {"uberon", ColumnRole::kTerm, "UBERON"},
    {"neuronames", ColumnRole::kTerm, "NeuroNames"},
    {"a", ColumnRole::kUnused},
    {"alpha", ColumnRole::kUnused},
    {"color_a", ColumnRole::kUnused},
    {"vis", ColumnRole::kUnused},
    {"msh", ColumnRole::kUnused},
    {"visible", ColumnRole::kUnused},
};

/// Sequences of codes, in 3D Slicer's tables and by their names in DICOM.
constexpr std::array<std::array<const char*, 2>, 10> kSequences{{
    {"category", "category"},
    {"type", ""},
    {"typemodifier", "modifier"},
    {"region", "region"},
    {"regionmodifier", "region modifier"},
    {"segmentedpropertycategorycodesequence", "category"},
    {"segmentedpropertytypecodesequence", ""},
    {"segmentedpropertytypemodifiercodesequence", "modifier"},
    {"anatomicregionsequence", "region"},
    {"anatomicregionmodifiersequence", "region modifier"},
}};

std::string plain_name(std::string_view name) {
  std::string plain = to_lower(trimmed(name));
  std::ranges::replace_if(
      plain, [](char c) { return c == ' ' || c == '-' || c == '.' || c == ':'; }, '_');
  return plain;
}

const Alias* find_alias(std::string_view plain) {
  const auto* found =
      std::ranges::find(kAliases, plain, [](const Alias& a) { return std::string_view(a.name); });
  return found == std::end(kAliases) ? nullptr : found;
}

/// "type_codevalue" and the like.
std::optional<Column> column_of_code(std::string_view plain) {
  const std::size_t dash = plain.find('_');
  if (dash == std::string_view::npos) return std::nullopt;
  for (const auto& [sequence, vocabulary] : kSequences) {
    if (plain.substr(0, dash) != sequence) continue;
    const std::string_view part = plain.substr(dash + 1);
    if (part == "codingscheme" || part == "codingschemedesignator")
      return Column{ColumnRole::kScheme, vocabulary};
    if (part == "codevalue") return Column{ColumnRole::kSchemeCode, vocabulary};
    if (part == "codemeaning") return Column{ColumnRole::kUnused, {}};
  }
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

bool has_labels(const Table& table, std::size_t column) {
  for (const Table::Row& row : table.rows) {
    if (column < row.fields.size() && !row.fields[column].empty())
      return parse_number(row.fields[column]).has_value();
  }
  return true;
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
      table.columns = std::move(row->fields);
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
  if (const Alias* alias = find_alias(plain)) return {alias->role, alias->vocabulary};
  if (const auto code = column_of_code(plain)) return *code;
  if (const auto language = column_of_language(plain)) return *language;
  for (const std::string_view suffix : {"_id", "_code", "id"}) {  // "FMA ID", "snomed_code"
    if (!plain.ends_with(suffix)) continue;
    const Alias* alias = find_alias(plain.substr(0, plain.size() - suffix.size()));
    if (alias != nullptr && alias->role == ColumnRole::kTerm) return {alias->role, alias->vocabulary};
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
  if (find_column(columns, ColumnRole::kName) == std::string::npos) {  // "index,label": the label is a name
    for (std::size_t n = 0; n < columns.size(); ++n) {
      if (columns[n].role == ColumnRole::kLabel && !has_labels(table, n)) columns[n].role = ColumnRole::kName;
    }
  }
  // One column for each role: the alias that stands first in the list.
  for (int role = static_cast<int>(ColumnRole::kLabel); role <= static_cast<int>(ColumnRole::kPath); ++role) {
    std::size_t best = std::string::npos;
    const auto rank = [&](std::size_t n) { return find_alias(plain_name(table.columns[n])); };
    for (std::size_t n = 0; n < columns.size(); ++n) {
      if (static_cast<int>(columns[n].role) != role) continue;
      if (best == std::string::npos || rank(n) < rank(best)) best = n;
    }
    for (std::size_t n = 0; n < columns.size(); ++n) {
      if (static_cast<int>(columns[n].role) == role && n != best) columns[n].role = ColumnRole::kUnknown;
    }
  }
  return columns;
}

}  // namespace splatlas
