#include "preprocess/import/images/image_io.h"

#include <algorithm>

#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>

namespace splatlas {

itk::ImageIOBase::Pointer make_image_io(ImageFormat format) {
  switch (format) {
    case ImageFormat::kNifti: return itk::NiftiImageIO::New().GetPointer();
    case ImageFormat::kNrrd: return itk::NrrdImageIO::New().GetPointer();
    case ImageFormat::kMetaImage: break;
  }
  return itk::MetaImageIO::New().GetPointer();
}

VoxelType voxel_type_of(itk::IOComponentEnum component) {
  switch (component) {
    case itk::IOComponentEnum::UCHAR: return VoxelType::kUInt8;
    case itk::IOComponentEnum::CHAR: return VoxelType::kInt8;
    case itk::IOComponentEnum::USHORT: return VoxelType::kUInt16;
    case itk::IOComponentEnum::SHORT: return VoxelType::kInt16;
    case itk::IOComponentEnum::UINT: return VoxelType::kUInt32;
    case itk::IOComponentEnum::INT: return VoxelType::kInt32;
    case itk::IOComponentEnum::FLOAT: return VoxelType::kFloat32;
    case itk::IOComponentEnum::DOUBLE: return VoxelType::kFloat64;
    default: return VoxelType::kNone;
  }
}

itk::IOComponentEnum component_of(VoxelType type) {
  switch (type) {
    case VoxelType::kUInt8: return itk::IOComponentEnum::UCHAR;
    case VoxelType::kInt8: return itk::IOComponentEnum::CHAR;
    case VoxelType::kUInt16: return itk::IOComponentEnum::USHORT;
    case VoxelType::kInt16: return itk::IOComponentEnum::SHORT;
    case VoxelType::kUInt32: return itk::IOComponentEnum::UINT;
    case VoxelType::kInt32: return itk::IOComponentEnum::INT;
    case VoxelType::kFloat32: return itk::IOComponentEnum::FLOAT;
    case VoxelType::kFloat64: return itk::IOComponentEnum::DOUBLE;
    case VoxelType::kNone: break;
  }
  return itk::IOComponentEnum::UNKNOWNCOMPONENTTYPE;
}

Grid grid_of(const itk::ImageIOBase& io) {
  Grid grid;
  grid.size = {1, 1, 1};
  const unsigned axes = std::min(3u, io.GetNumberOfDimensions());
  for (unsigned a = 0; a < axes; ++a) {
    grid.size[a] = static_cast<std::int64_t>(io.GetDimensions(a));
    grid.spacing_mm[a] = io.GetSpacing(a);
    grid.origin_lps_mm[a] = io.GetOrigin(a);
    const std::vector<double> direction = io.GetDirection(a);
    for (unsigned row = 0; row < 3; ++row) {
      // + 0.0 turns -0 into 0, so that equal grids print alike.
      grid.direction_lps[3 * row + a] = (row < direction.size() ? direction[row] : 0.0) + 0.0;
    }
  }
  return grid;
}

}  // namespace splatlas
