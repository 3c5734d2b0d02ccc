// Set of selections of one atlas for the bench `skip`.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "format/content/selection.h"
#include "format/content/structure_graph.h"

namespace splatlas {

struct NamedSelection {
  std::string name;
  Selection selection;
};

/// Every structure alone, groups with their descendants, all volumes with the appearance of `draw`; and
/// `unions` of 2, 4, 8 ... random leaves, equal in every run.
[[nodiscard]] std::vector<NamedSelection> many_selections(const StructureGraph& graph,
                                                          const StructureDraw& draw, std::size_t unions);

}  // namespace splatlas
