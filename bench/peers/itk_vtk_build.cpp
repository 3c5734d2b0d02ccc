#include "bench/peers/itk_vtk_build.h"

#include <string>

#include <itkImage.h>
#include <itkImageFileReader.h>
#include <itkNiftiImageIO.h>
#include <vtkDiscreteMarchingCubes.h>
#include <vtkImageData.h>
#include <vtkImageImport.h>
#include <vtkMarchingCubes.h>
#include <vtkNew.h>
#include <vtkPolyData.h>

namespace splatlas {
namespace {

using Image = itk::Image<std::int16_t, 3>;

Image::Pointer load(const std::filesystem::path& file) {
  const auto reader = itk::ImageFileReader<Image>::New();
  reader->SetImageIO(itk::NiftiImageIO::New());
  reader->SetFileName(file.string());
  reader->Update();
  return reader->GetOutput();
}

/// Shows an ITK image to VTK without a copy.
void share_voxels(Image& image, vtkImageImport& import) {
  const auto size = image.GetLargestPossibleRegion().GetSize();
  import.SetDataScalarTypeToShort();
  import.SetWholeExtent(0, static_cast<int>(size[0]) - 1, 0, static_cast<int>(size[1]) - 1, 0,
                        static_cast<int>(size[2]) - 1);
  import.SetDataExtentToWholeExtent();
  import.SetImportVoidPointer(image.GetBufferPointer());
  import.Update();
}

std::uint64_t march(vtkImageImport& image, vtkMarchingCubes& cubes) {
  cubes.SetInputConnection(image.GetOutputPort());
  cubes.ComputeNormalsOff();
  cubes.ComputeGradientsOff();
  cubes.Update();
  return static_cast<std::uint64_t>(cubes.GetOutput()->GetNumberOfPolys());
}

std::uint64_t march_at(Image& image, double value) {
  vtkNew<vtkImageImport> import;
  share_voxels(image, *import);
  vtkNew<vtkMarchingCubes> cubes;
  cubes->SetValue(0, value);
  return march(*import, *cubes);
}

std::uint64_t march_labels(Image& image, int labels) {
  vtkNew<vtkImageImport> import;
  share_voxels(image, *import);
  vtkNew<vtkDiscreteMarchingCubes> cubes;
  cubes->GenerateValues(labels, 1, labels);
  return march(*import, *cubes);
}

}  // namespace

Result<std::uint64_t> load_and_march(const ItkVtkSources& sources, int labels, double threshold) {
  try {
    const Image::Pointer volume = load(sources.volume);
    const Image::Pointer label_map = load(sources.labels);
    const Image::Pointer mask = load(sources.mask);
    return march_labels(*label_map, labels) + march_at(*mask, 0.5) + march_at(*volume, threshold);
  } catch (const itk::ExceptionObject& error) {
    return fail(ErrorCode::kFailed, std::string("ITK cannot load the files: ") + error.GetDescription());
  }
}

}  // namespace splatlas
