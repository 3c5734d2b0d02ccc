// splatlas-player info: what an atlas holds.
#pragma once

#include <string>

#include "format/atlas_reader.h"

namespace splatlas {

/// The contract's JSON document.
[[nodiscard]] std::string info_json(const Atlas& atlas);
/// The same for people: grid, sizes, and the structures as a tree.
[[nodiscard]] std::string info_text(const Atlas& atlas);

}  // namespace splatlas
