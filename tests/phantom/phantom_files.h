// The golden phantom as the files that splatlas-preprocess takes.
#pragma once

#include <filesystem>

#include "format/result.h"

namespace splatlas::phantom {

/// Writes labels.nrrd, volume.nrrd (uint8, raw, LPS, 1 mm), names.txt and phantom.tree into `folder`, which
/// is made where it is missing. By plain streams, so that readers are tested against bytes that no library of
/// theirs wrote. kFailed names the file that could not be written.
[[nodiscard]] Result<void> write_files(const std::filesystem::path& folder);

}  // namespace splatlas::phantom
