// Content of an atlas as plain text, stored beside golden files.
#pragma once

#include <string>

#include "format/atlas_content.h"

namespace splatlas {

/// All numbers; equal text for equal content.
[[nodiscard]] std::string content_text(const AtlasContent& content);

}  // namespace splatlas
