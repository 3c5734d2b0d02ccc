// Reader of TIFF files, by libtiff. ITK's reader takes integers of 32 bits for background.
#pragma once

#include <filesystem>

#include "preprocess/import/images/pixels/source_image.h"

namespace splatlas {

/// Reads all pages as slices, without spacing and orientation. kFailed for colours, palettes, pages of
/// several sizes or types, unsupported types, and damage. BigTIFF and every compression of libtiff are read.
/// Cost: one pass.
[[nodiscard]] Result<SourceImage> read_tiff(const std::filesystem::path& path);

}  // namespace splatlas
