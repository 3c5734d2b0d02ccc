// Reads NIfTI: the grid as ITK has it, the pixels exactly.
#pragma once

#include "preprocess/import/images/import_image.h"

namespace splatlas {

/// Reads a .nii or .nii.gz file that check_image_file has passed.
///
/// ITK says what the grid is, with one exception: an sform alone whose columns stand at right angles to
/// 1e-4. Of such, ITK 5.2 refuses one in sixty for float rounding; they get the nearest orthonormal direction
/// here, which differs from ITK's by that rounding.
///
/// Pixels are not read by ITK: NIfTI's library replaces NaN and infinity by 0 and takes the pixels of
/// scan.nii for scan.nii.gz when both are there. scl_slope and scl_inter are applied as NIfTI says, which
/// makes floats (doubles stay doubles). Throws what ITK throws: for call_itk.
[[nodiscard]] Result<Image> read_nifti_file(const std::filesystem::path& path);

}  // namespace splatlas
