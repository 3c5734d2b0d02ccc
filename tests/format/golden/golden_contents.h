// Contents of the golden files.
#pragma once

#include <string>
#include <vector>

#include "format/atlas_content.h"

namespace splatlas {

struct GoldenContent {
  std::string name;  ///< file name
  AtlasContent content;
  bool compact = false;
};

/// Small atlases that together cover all features of the format and all value types.
[[nodiscard]] std::vector<GoldenContent> golden_contents();

}  // namespace splatlas
