// Tables with columns id, name and parent, or path. An id may be text; a whole one is the label, too.
#include <algorithm>

#include "format/result_macros.h"
#include "preprocess/import/tables/table_columns.h"
#include "preprocess/import/tables/table_entries.h"
#include "preprocess/import/tables/text_file.h"
#include "preprocess/import/tables/trees/dialects.h"

namespace splatlas {

bool recognise_table_tree(std::string_view head) {
  const auto separator = find_separator(head);
  if (!separator) return false;
  const Table table = parse_table(lines_of(head).front().text, *separator);
  const std::vector<Column> columns = columns_of(table);
  const auto has = [&](ColumnRole role) { return find_column(columns, role) != std::string::npos; };
  return (has(ColumnRole::kName) || has(ColumnRole::kKey) || has(ColumnRole::kLabel)) &&
         (has(ColumnRole::kParent) || has(ColumnRole::kPath));
}

Result<std::vector<TreeLine>> read_table_tree(const NamesInput& input, NamesCollector& into) {
  const auto separator = find_separator(input.text);
  SPLATLAS_ASSIGN_OR_RETURN(const TableEntries entries,
                            read_entries(parse_table(input.text, separator.value_or(',')), input, into));
  if (entries.entries.empty()) return input.refuse("has no row below its header; add some");
  return hierarchy_of(entries);
}

}  // namespace splatlas
