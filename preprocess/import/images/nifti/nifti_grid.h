// Geometry of NIfTI and Analyze headers.
#pragma once

#include "format/content/grid.h"
#include "preprocess/import/images/nifti/nifti_header.h"
#include "preprocess/import/notes.h"

namespace splatlas {

/// The grid of a header, in LPS mm. As nibabel and the standard say: the sform if its code is above 0, else
/// the qform, else no orientation (x to the left, centred: LAS). A sheared sform gives a sheared grid. A
/// warning tells if sform and qform place voxels differently, and if there is no orientation. kFailed for
/// geometry that cannot be.
[[nodiscard]] Result<Grid> nifti_grid(const NiftiHeader& header, const std::filesystem::path& path,
                                      Notes& notes);

/// The grid of an affine from indices to RAS mm, row by row. Columns that are orthogonal within the rounding
/// of floats become exactly so. Not validated.
[[nodiscard]] Grid grid_of_ras_affine(const Index3& size, const std::array<double, 12>& affine);

}  // namespace splatlas
