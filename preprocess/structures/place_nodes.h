// Placement of structures by the nodes of a table or JSON tree.
#pragma once

#include <span>
#include <string>

#include "preprocess/import/notes.h"
#include "preprocess/import/tables/tree_line.h"
#include "preprocess/structures/graph_parts.h"

namespace splatlas {

/// Places structures by the nodes with their labels, or else their names. Nodes without a structure are
/// groups if a structure is below them; otherwise they are left out and counted as a note, as are parents
/// that do not exist and edges that close a circle. kFailed if no node fits a structure. Linear in nodes and
/// parents.
[[nodiscard]] Result<void> place_nodes(std::span<const TreeLine> lines, const std::string& file,
                                       const SourceLookup& sources, GraphParts& parts, Notes& notes);

}  // namespace splatlas
