// Construction of the structure graph from sources and a tree.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "format/content/structure_graph.h"
#include "preprocess/import/notes.h"
#include "preprocess/import/tables/names_table.h"

namespace splatlas {

/// The graph, with the mapping from sources.
struct PlacedStructures {
  StructureGraph graph;
  std::vector<StructureIndex> index_of_source;  ///< [source number]: structure
};

/// Assigns unique ids and places the structures by the tree (see build --help); without lines, all are roots.
/// Lines and nodes that fit no structure are counted in `notes`. kFailed, with the line, for malformed lists
/// of codes and labels; kFailed if nothing of the tree fits, and for cycles of paths. Messages call the tree
/// `file`. Cost: linear in sources and lines; a line with a pattern or codes takes a pass over the sources.
[[nodiscard]] Result<PlacedStructures> build_graph(std::span<const SourceStructure> sources,
                                                   std::span<const TreeLine> lines, const std::string& file,
                                                   Notes& notes);

}  // namespace splatlas
