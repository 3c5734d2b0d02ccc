// Smooth analytic field without borders, for orders of convergence.
#pragma once

#include "format/atlas_content.h"
#include "format/selection.h"
#include "player/camera.h"
#include "tests/reference/reference_picture.h"
#include "tests/reference/reference_radiance.h"

namespace splatlas {

/// Four Gaussians around the origin of a cube of kFieldSideMm, which vanish at its faces. Grey values range
/// from 0 to about 1.
inline constexpr double kFieldSideMm = 48;
/// Extinction of grey value 1, 1/mm; proportional up to 2, above all grey values.
inline constexpr double kFieldExtinctionPerMm = 0.15;
[[nodiscard]] double smooth_field(const Vec3& at_mm);

/// Samples of the field at the centres of cubic voxels, as the grey values of one structure, "field".
[[nodiscard]] AtlasContent sampled_field(double voxel_mm);

/// Extinction and shade proportional to the grey value, per mm, for any voxel size.
[[nodiscard]] Selection field_selection(const AtlasContent& content, double voxel_mm);

/// Ground truth of the field itself, in double precision.
[[nodiscard]] reference::ReferencePicture field_truth(const View& view);

}  // namespace splatlas
