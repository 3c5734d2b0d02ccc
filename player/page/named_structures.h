// Structures of a picture with their names.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "player/page/page_layout.h"
#include "player/renderer.h"

namespace splatlas {

/// A text as one printable line, cut off if it is too long to lay out.
[[nodiscard]] std::string printed_line(std::string_view text);
/// The same with its line feeds.
[[nodiscard]] std::string printed_lines(std::string_view text);

/// The structures in a picture of the renderer's selection, in the order of the tree, with blanks for
/// underscores. `labelled`: [structure], may get a label; empty: all may. Cost: 40 000 picks.
[[nodiscard]] std::vector<NamedStructure> named_structures(const Frame& frame, const Renderer& renderer,
                                                           const std::vector<bool>& labelled);

}  // namespace splatlas
