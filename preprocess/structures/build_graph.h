// Construction of the structure graph from sources and a tree.
#pragma once

#include <span>
#include <string>
#include <unordered_set>
#include <vector>

#include "format/content/structure_graph.h"
#include "preprocess/import/notes.h"
#include "preprocess/import/tables/names_table.h"

namespace splatlas {

/// The graph, with the mapping from sources.
struct PlacedStructures {
  StructureGraph graph;
  std::vector<StructureIndex> index_of_source;  ///< [source number]: structure
  std::unordered_set<StructureIndex> colored;   ///< by the tree
};

/// Assigns unique ids and places the structures by the tree (see build --help); without lines, all are roots.
/// Without a colour in its source or the tree, a structure has the anatomical one, or else a distinct hue.
/// Lines and nodes that fit no structure are counted in `notes`. kFailed, with the line, for malformed lists
/// of codes and labels; kFailed if nothing of the tree fits, and for cycles of paths. Messages call the tree
/// `file`. Cost: linear in sources and lines; a line with a pattern or codes takes a pass over the sources.
[[nodiscard]] Result<PlacedStructures> build_graph(std::span<const SourceStructure> sources,
                                                   std::span<const TreeLine> lines, const std::string& file,
                                                   Notes& notes);

}  // namespace splatlas
