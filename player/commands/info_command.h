// Command splatlas-player info: contents of an atlas.
#pragma once

#include <string>

#include "format/atlas_reader.h"
#include "format/text/printable_text.h"

namespace splatlas {

/// JSON document, safe to print, with grid, structures, counts and sizes.
[[nodiscard]] std::string info_json(const Atlas& atlas);
/// Text with grid, sizes and the tree of structures.
[[nodiscard]] PrintableText info_text(const Atlas& atlas);

}  // namespace splatlas
