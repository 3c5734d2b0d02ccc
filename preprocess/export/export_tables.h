// Export of names and trees as tables.
#pragma once

#include <string>

#include "format/content/structure_graph.h"
#include "preprocess/import/tables/names_table.h"

namespace splatlas {

/// The labelled structures as a names file. kCsv is the only one that holds all: structures without
/// labels, terms and colours. kUsage for dialects that are only read. Names are written as the dialect can
/// hold them: 3D Slicer and FreeSurfer have "_" for blanks. kLimit for a CSV of more than kMaxTextBytes: it
/// has a cell for each structure and vocabulary.
[[nodiscard]] Result<std::string> names_text(const StructureGraph& graph, NamesFormat format);

/// Properties of the structures that a names file of this dialect loses, as words: "colours"; "" for none.
[[nodiscard]] std::string losses_of(const StructureGraph& graph, NamesFormat format);

/// The hierarchy as a tree file, with colours: a line for each path of each structure.
/// Structures whose name is not unique, or would not be read as a name, are written as their id. kLimit for a
/// text of more than kMaxTextBytes: paths may be exponential in structures.
[[nodiscard]] Result<std::string> tree_text(const StructureGraph& graph);

}  // namespace splatlas
