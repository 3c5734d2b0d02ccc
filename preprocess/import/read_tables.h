// Readers of names and trees, in a child.
#pragma once

#include "preprocess/import/tables/names/read_names.h"
#include "preprocess/import/tables/read_tree.h"

namespace splatlas {

/// read_names() and read_tree() in a child, so that no file brings this process down (run_isolated.h).
[[nodiscard]] Result<NamesTable> read_names_isolated(const std::filesystem::path& path, NamesFormat format,
                                                     Notes& notes);
[[nodiscard]] Result<std::vector<TreeLine>> read_tree_isolated(const std::filesystem::path& path,
                                                               Notes& notes);

}  // namespace splatlas
