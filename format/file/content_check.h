// Consistency check of atlas content before writing.
#pragma once

#include "format/atlas_content.h"
#include "format/result.h"

namespace splatlas {

/// kFailed if sizes, class ids, counts, boxes or the order of classes are inconsistent. validate(Directory)
/// checks the directory, and encode_surface() checks surfaces. Cost: one pass over the class volume.
[[nodiscard]] Result<void> check_content(const AtlasContent& content);

}  // namespace splatlas
