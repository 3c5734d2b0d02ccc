// What golden files are made of.
#pragma once

#include <string>
#include <vector>

#include "format/atlas_content.h"

namespace splatlas {

struct GoldenContent {
  std::string name;  ///< of the file
  AtlasContent content;
  bool compact = false;
};

/// Small atlases that together have every feature of the format and every type of values.
[[nodiscard]] std::vector<GoldenContent> golden_contents();

}  // namespace splatlas
