// JSON files of names that have a hierarchy: Allen, BrainGlobe, Open Anatomy.
#include "format/result_macros.h"
#include "preprocess/import/tables/json_text.h"
#include "preprocess/import/tables/names/dialects.h"
#include "preprocess/import/tables/trees/dialects.h"

namespace splatlas {

bool recognise_json_tree(std::string_view head) {
  return is_json(head);
}

Result<std::vector<TreeLine>> read_json_tree(const NamesInput& input, NamesCollector& into) {
  const std::string_view head = std::string_view(input.text).substr(0, kNamesHeadBytes);
  const std::string file = input.path.filename().string();
  if (recognise_open_anatomy(head, file)) {
    SPLATLAS_RETURN_IF_ERROR(read_open_anatomy(input, into));
  } else if (recognise_brainglobe(head, file)) {
    SPLATLAS_RETURN_IF_ERROR(read_brainglobe(input, into));
  } else if (recognise_allen(head, file)) {
    SPLATLAS_RETURN_IF_ERROR(read_allen(input, into));
  } else {
    return input.refuse("is no tree of the Allen Brain Atlas, of BrainGlobe or of Open Anatomy; give one");
  }
  SPLATLAS_ASSIGN_OR_RETURN(NamesTable table, into.finish());
  return std::move(table.hierarchy);
}

}  // namespace splatlas
