// BIDS: _dseg.tsv with the columns index and name, in tabs.
#include <algorithm>

#include "format/result_macros.h"
#include "preprocess/import/tables/names/dialects.h"
#include "preprocess/import/tables/table_entries.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

bool has_column(const Table& table, std::string_view name) {
  return std::ranges::find(table.columns, name) != table.columns.end();
}

}  // namespace

bool recognise_bids(std::string_view head, std::string_view /*file*/) {
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
  SPLATLAS_ASSIGN_OR_RETURN(TableEntries entries, read_entries(table, input, into));
  add_entries(std::move(entries), into);
  return {};
}

}  // namespace splatlas
