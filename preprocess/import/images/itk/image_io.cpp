#include "preprocess/import/images/itk/image_io.h"

#include <algorithm>
#include <array>
#include <utility>

#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>

namespace splatlas {
namespace {

using TypePair = std::pair<VoxelType, itk::IOComponentEnum>;
constexpr std::array<TypePair, 8> kTypes{{{VoxelType::kUInt8, itk::IOComponentEnum::UCHAR},
                                          {VoxelType::kInt8, itk::IOComponentEnum::CHAR},
                                          {VoxelType::kUInt16, itk::IOComponentEnum::USHORT},
                                          {VoxelType::kInt16, itk::IOComponentEnum::SHORT},
                                          {VoxelType::kUInt32, itk::IOComponentEnum::UINT},
                                          {VoxelType::kInt32, itk::IOComponentEnum::INT},
                                          {VoxelType::kFloat32, itk::IOComponentEnum::FLOAT},
                                          {VoxelType::kFloat64, itk::IOComponentEnum::DOUBLE}}};

}  // namespace

itk::ImageIOBase::Pointer make_image_io(ImageFormat format) {
  switch (format) {
    case ImageFormat::kNifti: return itk::NiftiImageIO::New().GetPointer();
    case ImageFormat::kNrrd: return itk::NrrdImageIO::New().GetPointer();
    case ImageFormat::kMetaImage: break;
  }
  return itk::MetaImageIO::New().GetPointer();
}

VoxelType voxel_type_of(itk::IOComponentEnum component) {
  const auto found = std::ranges::find(kTypes, component, &TypePair::second);
  return found == kTypes.end() ? VoxelType::kNone : found->first;
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
