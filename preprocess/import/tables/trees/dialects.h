// The readers of trees. Each is one source file; read_tree.cpp has the table of them.
#pragma once

#include <vector>

#include "preprocess/import/tables/names_collector.h"

namespace splatlas {

// recognise_...(head): whether the content is of this dialect, by the first bytes of a file.
//
// read_...(input, collector): the lines of the tree; faults are counted by the collector.

[[nodiscard]] bool recognise_json_tree(std::string_view head);
/// The hierarchy of a JSON file of names.
[[nodiscard]] Result<std::vector<TreeLine>> read_json_tree(const NamesInput& input, NamesCollector& into);

[[nodiscard]] bool recognise_table_tree(std::string_view head);
[[nodiscard]] Result<std::vector<TreeLine>> read_table_tree(const NamesInput& input, NamesCollector& into);

[[nodiscard]] bool recognise_path_tree(std::string_view head);
[[nodiscard]] Result<std::vector<TreeLine>> read_path_tree(const NamesInput& input, NamesCollector& into);

}  // namespace splatlas
