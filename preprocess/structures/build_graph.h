// Structures and a tree file become the structure graph.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "format/structure_graph.h"
#include "preprocess/import/tables/read_tree.h"
#include "preprocess/source_structure.h"

namespace splatlas {

struct PlacedStructures {
  StructureGraph graph;
  std::vector<StructureIndex> index_of_source;  ///< source number -> structure
};

/// Gives every structure a unique id and its place, as kTreeFormat says; without lines, all are roots. `file`
/// stands for the tree file in messages. kFailed names the line of a last part that fits nothing or is
/// ambiguous, of a code list that is malformed, and tells of cycles.
[[nodiscard]] Result<PlacedStructures> build_graph(std::span<const SourceStructure> sources,
                                                   std::span<const TreeLine> lines, const std::string& file);

}  // namespace splatlas
