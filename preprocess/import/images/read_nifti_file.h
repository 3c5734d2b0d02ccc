// Reader of NIfTI volumes: ITK's grid, bit-exact pixels.
#pragma once

#include "preprocess/import/images/import_image.h"

namespace splatlas {

/// Reads a .nii or .nii.gz file in one pass; errors as NiftiFile.
///
/// ITK reads the grid, with one exception: an sform without a qform whose columns are orthogonal to 1e-4. ITK
/// 5.2 rejects one in sixty of these because of rounding to floats. Here they get the nearest orthonormal
/// direction, equal to ITK's up to that rounding.
///
/// ITK does not read the pixels: NIfTI's library replaces NaN and infinity by 0 and takes the pixels of
/// scan.nii for scan.nii.gz when both exist. Throws ITK's exceptions: for call_itk.
[[nodiscard]] Result<Image> read_nifti_file(const std::filesystem::path& path);

}  // namespace splatlas
