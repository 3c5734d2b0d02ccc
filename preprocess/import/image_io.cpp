#include "preprocess/import/image_io.h"

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

}  // namespace splatlas
