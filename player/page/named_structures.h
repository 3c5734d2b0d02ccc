// Structures of a picture with their names.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "format/content/selection.h"
#include "player/page/page_layout.h"

namespace splatlas {

/// A text as one printable line, cut off if it is too long to lay out.
[[nodiscard]] std::string printed_line(std::string_view text);
/// The same with its line feeds.
[[nodiscard]] std::string printed_lines(std::string_view text);

/// The structures in a picture of a selection, in the order of the tree, with blanks for underscores.
/// `labelled`: [structure], may get a label; empty: all may. Cost: 40 000 calls of `at`.
[[nodiscard]] std::vector<NamedStructure> named_structures(const Picture& picture, const StructureAt& at,
                                                           const StructureGraph& graph,
                                                           const Selection& selection,
                                                           const std::vector<bool>& labelled);

}  // namespace splatlas
