// What the writer asks of content before it writes a byte.
#pragma once

#include "format/atlas_content.h"
#include "format/result.h"

namespace splatlas {

/// Checks that the parts of the content fit together: sizes, class numbers, counts, boxes and order. What a
/// directory can tell by itself is checked by validate(Directory); surfaces by encode_surface(). kFailed.
/// Cost: one pass over the class volume.
[[nodiscard]] Result<void> check_content(const AtlasContent& content);

}  // namespace splatlas
