// Source files of the golden phantom for splatlas-preprocess.
#pragma once

#include <filesystem>

#include "format/result.h"

namespace splatlas::phantom {

/// Writes labels.nrrd, volume.nrrd (uint8, raw, LPS, 1 mm), names.txt and phantom.tree into `folder`, which
/// is created if missing. By plain streams: no library tests its own output. kFailed names the file.
[[nodiscard]] Result<void> write_files(const std::filesystem::path& folder);

}  // namespace splatlas::phantom
