// ITK image readers, without ITK's object factories.
#pragma once

#include <itkImageIOBase.h>

#include "format/content/grid.h"
#include "format/content/voxel_type.h"
#include "preprocess/import/images/pixels/check_image_file.h"

namespace splatlas {

[[nodiscard]] itk::ImageIOBase::Pointer make_image_io(ImageFormat format);

/// Voxel type of an ITK component type; kNone for unsupported types such as 64-bit integers.
[[nodiscard]] VoxelType voxel_type_of(itk::IOComponentEnum component);

/// The grid of the file whose header `io` has read. A 2-D image gets a third, orthogonal axis of size 1.
[[nodiscard]] Grid grid_of(const itk::ImageIOBase& io);

}  // namespace splatlas
