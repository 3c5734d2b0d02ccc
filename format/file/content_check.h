// Check of content ahead of writing.
#pragma once

#include "format/content/atlas_content.h"
#include "format/result.h"

namespace splatlas {

/// kFailed if sizes, class ids, counts, boxes or the order of classes of the content are inconsistent.
/// validate() checks its directory, and encode_surface() its surfaces. Cost: one pass over the class volume.
[[nodiscard]] Result<void> check_content(const AtlasContent& content);

}  // namespace splatlas
