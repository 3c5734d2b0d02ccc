#include "tests/preprocess/itk_volumes.h"

#include <array>
#include <vector>

#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>

#include "preprocess/import/images/itk/itk_call.h"

namespace splatlas {
namespace {

itk::IOComponentEnum component_of(VoxelType type) {
  using Type = itk::IOComponentEnum;
  constexpr std::array<Type, 9> kTypes{Type::UNKNOWNCOMPONENTTYPE,
                                       Type::UCHAR,
                                       Type::CHAR,
                                       Type::USHORT,
                                       Type::SHORT,
                                       Type::UINT,
                                       Type::INT,
                                       Type::FLOAT,
                                       Type::DOUBLE};
  return kTypes[static_cast<std::size_t>(type)];
}

itk::ImageIOBase::Pointer make_image_io(const std::filesystem::path& path) {
  const std::filesystem::path ending = path.extension();
  if (ending == ".nrrd" || ending == ".nhdr") return itk::NrrdImageIO::New().GetPointer();
  if (ending == ".mha" || ending == ".mhd") return itk::MetaImageIO::New().GetPointer();
  return itk::NiftiImageIO::New().GetPointer();
}

}  // namespace

Image read_by_itk(const std::filesystem::path& path) {
  const itk::ImageIOBase::Pointer io = make_image_io(path);
  io->SetFileName(path.string());
  io->ReadImageInformation();
  Image image{grid_of(*io), {voxel_type_of(io->GetComponentType()), {}}};
  image.voxels.bytes.resize(static_cast<std::size_t>(image.grid.voxels()) * bytes_of(image.voxels.type));
  itk::ImageIORegion region(io->GetNumberOfDimensions());
  for (unsigned a = 0; a < io->GetNumberOfDimensions(); ++a) region.SetSize(a, io->GetDimensions(a));
  io->SetIORegion(region);
  io->Read(image.voxels.bytes.data());
  return image;
}

void write_by_itk(const Image& image, const std::string& path) {
  const itk::NiftiImageIO::Pointer io = itk::NiftiImageIO::New();
  io->SetFileName(path);
  io->SetNumberOfDimensions(3);
  itk::ImageIORegion region(3);
  for (unsigned a = 0; a < 3; ++a) {
    const auto size = static_cast<itk::SizeValueType>(image.grid.size[a]);
    io->SetDimensions(a, size);
    region.SetSize(a, size);
    io->SetSpacing(a, image.grid.spacing_mm[a]);
    io->SetOrigin(a, image.grid.origin_lps_mm[a]);
    const Matrix3& direction = image.grid.direction_lps;
    io->SetDirection(a, std::vector<double>{direction[a], direction[3 + a], direction[6 + a]});
  }
  io->SetIORegion(region);
  io->SetPixelType(itk::IOPixelEnum::SCALAR);
  io->SetNumberOfComponents(1);
  io->SetComponentType(component_of(image.voxels.type));
  io->Write(image.voxels.bytes.data());
}

}  // namespace splatlas
