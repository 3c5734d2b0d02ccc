// Warnings of selections and pictures that show less than expected.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "format/atlas_reader.h"
#include "format/content/selection.h"
#include "player/renderer.h"

namespace splatlas {

/// A line for each term of a selection that later ones hide, up to a limit.
[[nodiscard]] Result<std::vector<std::string>> selection_warnings(std::span<const SelectionTerm> terms,
                                                                  const Atlas& atlas);

/// Why a picture shows nothing; empty if it shows something.
[[nodiscard]] std::string emptiness_of(const Frame& frame);

}  // namespace splatlas
