// ITK's reader and writer of one file format, without its factories.
#pragma once

#include <itkImageIOBase.h>

#include "format/voxel_type.h"
#include "preprocess/import/check_image_file.h"

namespace splatlas {

[[nodiscard]] itk::ImageIOBase::Pointer make_image_io(ImageFormat format);

/// kNone for types that atlases do not take (64-bit integers, ...).
[[nodiscard]] VoxelType voxel_type_of(itk::IOComponentEnum component);
[[nodiscard]] itk::IOComponentEnum component_of(VoxelType type);

}  // namespace splatlas
