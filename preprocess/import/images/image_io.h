// ITK's reader and writer of one file format, without its factories.
#pragma once

#include <itkImageIOBase.h>

#include "format/grid.h"
#include "format/voxel_type.h"
#include "preprocess/import/images/check_image_file.h"

namespace splatlas {

[[nodiscard]] itk::ImageIOBase::Pointer make_image_io(ImageFormat format);

/// kNone for types that atlases do not take (64-bit integers, ...).
[[nodiscard]] VoxelType voxel_type_of(itk::IOComponentEnum component);
[[nodiscard]] itk::IOComponentEnum component_of(VoxelType type);

/// The grid of the file whose header `io` has read; axes that a 2-D image lacks are of size 1 and stand at
/// right angles.
[[nodiscard]] Grid grid_of(const itk::ImageIOBase& io);

}  // namespace splatlas
