// Reader of NRRD and MetaImage files, by ITK.
#pragma once

#include <filesystem>

#include "preprocess/import/images/pixels/source_image.h"

namespace splatlas {

/// Reads .nrrd, .nhdr and .seg.nrrd: layers from lists, vectors and a fourth axis; segments of 3D Slicer. A
/// warning tells if the axes have no anatomical meaning, and are read as LPS. kFailed, in one line, for files
/// that check_nrrd_file() or ITK reject. Cost: one pass.
[[nodiscard]] Result<SourceImage> read_nrrd(const std::filesystem::path& path);
/// Reads .mha and .mhd: layers from channels and a fourth axis.
[[nodiscard]] Result<SourceImage> read_meta_image(const std::filesystem::path& path);

}  // namespace splatlas
