// Construction of the structure graph from sources and a tree file.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "format/structure_graph.h"
#include "preprocess/import/tables/read_tree.h"
#include "preprocess/import/tables/source_structure.h"

namespace splatlas {

/// The graph, with the mapping from sources.
struct PlacedStructures {
  StructureGraph graph;
  std::vector<StructureIndex> index_of_source;  ///< [source number]: structure
};

/// Assigns unique ids and places the structures by the tree file (see kTreeFormat); without lines, all are
/// roots. kFailed, with the line, for members that match nothing or are ambiguous and for malformed code
/// lists; kFailed for cycles. Messages call the tree file `file`.
[[nodiscard]] Result<PlacedStructures> build_graph(std::span<const SourceStructure> sources,
                                                   std::span<const TreeLine> lines, const std::string& file);

}  // namespace splatlas
