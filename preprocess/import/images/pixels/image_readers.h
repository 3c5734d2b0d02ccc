// Readers of files of one image, without DICOM and pictures. They use no options.
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
[[nodiscard]] Result<SourceImage> read_nifti(const std::filesystem::path& path,
                                             const ImageOptions& options = {});

/// The file beside one of a pair; the path itself for other files.
[[nodiscard]] std::filesystem::path other_of_pair(const std::filesystem::path& path);

/// Reads .nrrd, .nhdr and .seg.nrrd: layers from lists, vectors and a fourth axis; segments of 3D Slicer. A
/// warning tells if the axes have no anatomical meaning, and are read as LPS. kFailed, in one line, for files
/// that check_nrrd_file() or ITK reject. Cost: one pass.
[[nodiscard]] Result<SourceImage> read_nrrd(const std::filesystem::path& path,
                                            const ImageOptions& options = {});
/// Reads .mha and .mhd: layers from channels and a fourth axis.
[[nodiscard]] Result<SourceImage> read_meta_image(const std::filesystem::path& path,
                                                  const ImageOptions& options = {});

/// Reads .mgh, .mgz and .mgh.gz (FreeSurfer wiki, MghFormat): scanner RAS, frames as layers. A warning tells
/// if the file has no orientation; FreeSurfer's own (1 mm, coronal) is taken then. kFailed for values of
/// surfaces (N x 1 x 1), axes that are no axes, unsupported types, and damaged files. One pass. Thread-safe.
[[nodiscard]] Result<SourceImage> read_mgh(const std::filesystem::path& path,
                                           const ImageOptions& options = {});

}  // namespace splatlas
