// Structure graphs of the Allen Brain Atlas API: nested structures, wrapped in msg[0] or bare.
#include "format/result_macros.h"
#include "preprocess/import/tables/json_text.h"
#include "preprocess/import/tables/names/dialects.h"
#include "preprocess/import/tables/table_entries.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

struct Nested {
  const Json* structure;
  std::string parent;  // its id
};

/// Nested structures as rows in depth-first order. The nesting tells the parent: some files have no field for
/// it.
Table flatten(const Json& roots) {
  Table table;
  table.columns = {"id", "name", "acronym", "color_hex_triplet", "parent_structure_id"};
  std::vector<Nested> pending;
  const auto push_all = [&](const Json& list, const std::string& parent) {
    if (list.is_object()) pending.push_back({&list, parent});
    if (!list.is_array()) return;
    for (auto item = list.rbegin(); item != list.rend(); ++item) {
      if (item->is_object()) pending.push_back({&*item, parent});
    }
  };
  push_all(roots, "");
  while (!pending.empty()) {
    const Nested next = pending.back();
    pending.pop_back();
    Table::Row row = row_of(*next.structure, table.rows.size() + 1, table.columns);
    row.fields.back() = next.parent;
    const auto children = next.structure->find("children");
    if (children != next.structure->end()) push_all(*children, row.fields.front());
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

bool recognise_allen(std::string_view head, std::string_view /*file*/) {
  return is_json(head) && has_json_key(head, "children") && has_json_key(head, "id");
}

Result<void> read_allen(const NamesInput& input, NamesCollector& into) {
  SPLATLAS_ASSIGN_OR_RETURN(const Json json, parse_json(input));
  const bool is_answer = json.is_object() && json.contains("msg");
  const Table table = flatten(is_answer ? json["msg"] : json);
  if (table.rows.empty()) return input.refuse("holds no structures; download the structure graph again");
  SPLATLAS_ASSIGN_OR_RETURN(TableEntries entries, read_entries(table, input, into));
  add_entries(std::move(entries), into);
  return {};
}

}  // namespace splatlas
