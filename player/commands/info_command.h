// Command splatlas-player info: contents of an atlas.
#pragma once

#include "format/atlas_reader.h"
#include "format/text/printable_text.h"

namespace splatlas {

/// Text with grid, sizes and the tree of structures.
[[nodiscard]] PrintableText info_text(const Atlas& atlas);

}  // namespace splatlas
