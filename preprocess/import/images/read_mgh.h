// Reader of FreeSurfer's MGH and MGZ volumes.
#pragma once

#include <filesystem>

#include "preprocess/import/images/pixels/source_image.h"

namespace splatlas {

/// Reads .mgh, .mgz and .mgh.gz (FreeSurfer wiki, MghFormat): scanner RAS, frames as layers. A warning tells
/// if the file has no orientation; FreeSurfer's own (1 mm, coronal) is taken then. kFailed for values of
/// surfaces (N x 1 x 1), axes that are no axes, unsupported types, and truncated or damaged files. Cost: one
/// pass. Thread-safe.
[[nodiscard]] Result<SourceImage> read_mgh(const std::filesystem::path& path);

}  // namespace splatlas
