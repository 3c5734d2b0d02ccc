#include "preprocess/import/tables/trees/read_tree.h"

#include <algorithm>

#include <fmt/format.h>

#include "format/result_macros.h"
#include "preprocess/import/tables/names/dialects.h"
#include "preprocess/import/tables/text_file.h"
#include "preprocess/import/tables/trees/dialects.h"

namespace splatlas {
namespace {

const NoteKind kTreeFormatNote{"tree-format", "", "", false};

struct TreeDialect {
  const char* title;
  bool (*recognise)(std::string_view head);
  Result<std::vector<TreeLine>> (*read)(const NamesInput& input, NamesCollector& into);
};

/// Detection takes the first that fits; the last fits all.
constexpr TreeDialect kTreeDialects[] = {
    {"JSON tree", recognise_json_tree, read_json_tree},
    {"table of parents or paths", recognise_table_tree, read_table_tree},
    {"tree file", recognise_path_tree, read_path_tree},
};

}  // namespace

Result<std::vector<TreeLine>> read_tree(const std::filesystem::path& path, Notes& notes) {
  SPLATLAS_ASSIGN_OR_RETURN(std::string text, read_text(path));
  const std::string_view head = std::string_view(text).substr(0, kNamesHeadBytes);
  const auto* dialect =
      std::ranges::find_if(kTreeDialects, [&](const TreeDialect& d) { return d.recognise(head); });
  const NamesInput input{path, std::move(text), dialect->title};
  NamesCollector faults(input, notes);
  auto lines = dialect->read(input, faults);
  if (lines && dialect->read != read_path_tree)
    notes.add(kTreeFormatNote, fmt::format("{} is read as {}", path.filename().string(), dialect->title));
  return lines;
}

}  // namespace splatlas
