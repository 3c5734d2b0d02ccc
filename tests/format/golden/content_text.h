// What an atlas holds, as plain text: golden files are kept with it.
#pragma once

#include <string>

#include "format/atlas_content.h"

namespace splatlas {

/// Everything, number by number; the same text for the same content.
[[nodiscard]] std::string content_text(const AtlasContent& content);

}  // namespace splatlas
