// BrainGlobe's structures.json: a list of structures with the path of ids to each.
#include <fmt/format.h>

#include "format/result_macros.h"
#include "preprocess/import/tables/json_text.h"
#include "preprocess/import/tables/names/dialects.h"
#include "preprocess/import/tables/table_entries.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {

bool recognise_brainglobe(std::string_view head, std::string_view /*file*/) {
  return is_json(head) && has_json_key(head, "structure_id_path");
}

Result<void> read_brainglobe(const NamesInput& input, NamesCollector& into) {
  SPLATLAS_ASSIGN_OR_RETURN(const Json json, parse_json(input));
  if (!json.is_array()) return input.refuse("is no list of structures; give the structures.json of an atlas");
  Table table;
  table.columns = {"id", "name", "acronym", "rgb_triplet", "structure_id_path"};
  for (std::size_t n = 0; n < json.size(); ++n) {
    if (!json[n].is_object()) {
      into.add_fault(n + 1, fmt::format("entry {} is no object", n + 1));
      continue;
    }
    table.rows.push_back(row_of(json[n], n + 1, table.columns));
  }
  SPLATLAS_ASSIGN_OR_RETURN(TableEntries entries, read_entries(table, input, into));
  add_entries(std::move(entries), into);
  return {};
}

}  // namespace splatlas
