// Readers of trees, which define the hierarchy of structures.
#pragma once

#include <filesystem>
#include <vector>

#include "format/result.h"
#include "preprocess/import/notes.h"
#include "preprocess/import/tables/names_table.h"

namespace splatlas {

/// Reads the lines of a tree file, or the nodes of a table or JSON file, by its content. Does not resolve
/// names. `notes` tells the format of tables, and counts their faults. kFailed with file and line of the
/// first fault of a tree file, and for tables without a usable row. Cost: linear in the file, at most 16 MiB.
[[nodiscard]] Result<std::vector<TreeLine>> read_tree(const std::filesystem::path& path, Notes& notes);

}  // namespace splatlas
