// Tables with named columns, separated by commas, semicolons or tabs; also rows "label,name" without header.
#include <algorithm>

#include <fmt/format.h>

#include "format/result_macros.h"
#include "preprocess/import/tables/names/dialects.h"
#include "preprocess/import/tables/table_entries.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

/// True for a first row such as "1,spleen": it is no header.
bool is_row(const std::vector<std::string>& header) {
  return header.size() > 1 && parse_label(header[0]) && !parse_number(header[1]);
}

/// Gives columns to a table without a header: label, name, and one or three of the colour.
void add_header(Table& table) {
  table.rows.insert(table.rows.begin(), {1, table.columns});
  static const std::vector<std::string> kShort{"label", "name", "color"};
  static const std::vector<std::string> kLong{"label", "name", "r", "g", "b", "a"};
  const std::vector<std::string>& all = table.columns.size() > 3 ? kLong : kShort;
  const std::size_t known = std::min(table.columns.size(), all.size());
  table.columns.resize(std::max(known, table.columns.size()));
  for (std::size_t n = 0; n < table.columns.size(); ++n)
    table.columns[n] = n < known ? all[n] : fmt::format("column {}", n + 1);
  if (known == 4) table.columns[2] = "column 3", table.columns[3] = "column 4";
}

// BIDS: _dseg.tsv with the columns index and name, in tabs.

bool has_column(const Table& table, std::string_view name) {
  return std::ranges::find(table.columns, name) != table.columns.end();
}

}  // namespace

bool recognise_csv(std::string_view head) {
  const auto separator = find_separator(head);
  if (!separator) return false;
  const std::vector<TextLine> lines = lines_of(head);
  const Table table = parse_table(lines.front().text, *separator);
  if (is_row(table.columns)) return *separator != '\t';  // else a list of labels and names
  if (parse_integer(split_blanks(lines.front().text).front())) return false;  // "7 lobe, label"
  for (const std::string& name : table.columns) {
    const ColumnRole role = column_of(name).role;
    if (role == ColumnRole::kLabel || role == ColumnRole::kKey || role == ColumnRole::kName) return true;
  }
  return false;
}

Result<void> read_csv(const NamesInput& input, NamesCollector& into) {
  const auto separator = find_separator(input.text);
  if (!separator)
    return input.refuse("line 1: holds no comma, semicolon or tab; give another --names-format");
  Table table = parse_table(input.text, *separator);
  if (is_row(table.columns)) add_header(table);
  return add_table(table, input, into);
}

bool recognise_bids(std::string_view head) {
  const std::vector<TextLine> lines = lines_of(head);
  if (lines.empty()) return false;
  const Table table = parse_table(lines.front().text, '\t');
  return has_column(table, "index") && has_column(table, "name");
}

Result<void> read_bids(const NamesInput& input, NamesCollector& into) {
  const Table table = parse_table(input.text, '\t');
  for (const char* name : {"index", "name"}) {
    if (has_column(table, name)) continue;
    return input.refuse(std::string("line 1: the column \"") + name + "\" is missing; add it, in tabs");
  }
  return add_table(table, input, into);
}

}  // namespace splatlas
