// A smooth field without borders, known everywhere: what orders of convergence are measured on.
#pragma once

#include "format/atlas_content.h"
#include "format/selection.h"
#include "player/camera.h"
#include "tests/reference/reference_picture.h"
#include "tests/reference/reference_radiance.h"

namespace splatlas {

/// Four Gaussians around the origin of a cube of kFieldSideMm, at whose faces nothing is left of them. Grey
/// values are from 0 to about 1.
inline constexpr double kFieldSideMm = 48;
/// Of a grey value of 1, 1/mm; in proportion to it up to 2, beyond all that there are.
inline constexpr double kFieldExtinctionPerMm = 0.15;
[[nodiscard]] double smooth_field(const Vec3& at_mm);

/// The field's samples at the centres of cubic voxels, as the grey values of one structure, "field".
[[nodiscard]] AtlasContent sampled_field(double voxel_mm);

/// Extinction and shade in proportion to the grey value; the same per mm whatever the voxels' size.
[[nodiscard]] Selection field_selection(const AtlasContent& content, double voxel_mm);

/// The picture of the field itself, in double precision.
[[nodiscard]] reference::ReferencePicture field_truth(const View& view);

}  // namespace splatlas
