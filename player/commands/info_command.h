// Command splatlas-player info: contents of an atlas.
#pragma once

#include <string>

#include "format/atlas_reader.h"

namespace splatlas {

/// Grid, structures, counts and sizes as a JSON document.
[[nodiscard]] std::string info_json(const Atlas& atlas);
/// The same as text: grid, sizes, and the structures as a tree.
[[nodiscard]] std::string info_text(const Atlas& atlas);

}  // namespace splatlas
