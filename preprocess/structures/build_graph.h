// Structures and a tree file become the structure graph.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "format/structure_graph.h"
#include "preprocess/structures/read_tree.h"

namespace splatlas {

/// A structure as its source gives it, before the tree file places it. Its number in a list of these is its
/// source number.
struct SourceStructure {
  std::string name;
  std::optional<std::int64_t> label;
  std::optional<std::int64_t> code;
  std::optional<Rgb> color;
  bool external = false;
};

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
