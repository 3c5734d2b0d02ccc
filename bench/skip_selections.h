// Many selections of one atlas.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "format/selection.h"
#include "format/structure_graph.h"

namespace splatlas {

struct NamedSelection {
  std::string name;
  Selection selection;
};

/// Every structure for itself, groups with what is below them, all volumes that look like `draw`; and
/// `unions` of 2, 4, 8 ... random leaves, the same in every run.
[[nodiscard]] std::vector<NamedSelection> many_selections(const StructureGraph& graph,
                                                          const StructureDraw& draw, std::size_t unions);

}  // namespace splatlas
