// Reader of NIfTI-1, NIfTI-2 and Analyze 7.5 files.
#pragma once

#include <filesystem>

#include "preprocess/import/images/pixels/source_image.h"

namespace splatlas {

/// Reads .nii, .nii.gz, and pairs of .hdr and .img (or .img.gz), by either name. Every volume beyond the
/// third axis is a layer. Applies scl_slope and scl_inter, with floats as result; doubles stay doubles. Names
/// of labels come from the header's extensions. kFailed for:
///   - files of another kind, and files whose ending contradicts their compression,
///   - geometry that cannot be (nifti_grid()), unsupported types, 64-bit integers beyond 32 bits,
///   - fewer bytes than the header promises, and damaged compression.
/// Cost: one pass. Thread-safe.
[[nodiscard]] Result<SourceImage> read_nifti(const std::filesystem::path& path);

/// The file beside one of a pair; the path itself for other files.
[[nodiscard]] std::filesystem::path other_of_pair(const std::filesystem::path& path);

}  // namespace splatlas
