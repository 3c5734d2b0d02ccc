// Resampling of images to another grid.
#pragma once

#include <optional>

#include "preprocess/import/images/import_image.h"
#include "preprocess/import/images/pixels/source_image.h"
#include "preprocess/import/membership_volume.h"

namespace splatlas {

/// The voxels of `image` that lie nearest to the voxels of `grid`; 0 beyond the image.
[[nodiscard]] VoxelBuffer resample_nearest(const Image& image, const Grid& grid);
/// The same for every layer.
[[nodiscard]] SourceImage resample_nearest(const SourceImage& image, const Grid& grid);

/// Trilinear interpolation at the voxels of `grid`, rounded for integers; the least value of the image beyond
/// it. Uses all cores.
[[nodiscard]] VoxelBuffer resample_linear(const Image& image, const Grid& grid);

/// Fraction of the voxels of `grid` that lie within `other`, estimated on a lattice of 32^3 points.
[[nodiscard]] double overlap(const Grid& grid, const Grid& other);

/// The voxels around a grid that it lacks to hold another one, in storage order; nullopt unless the voxels of
/// both lie on one lattice.
[[nodiscard]] std::optional<Margin> margin_around(const Grid& grid, const Grid& other);

/// The smallest grid that holds the voxels of both; nullopt unless they lie on one lattice, or for a grid
/// much larger than both.
[[nodiscard]] std::optional<Grid> union_of(const Grid& a, const Grid& b);

}  // namespace splatlas
