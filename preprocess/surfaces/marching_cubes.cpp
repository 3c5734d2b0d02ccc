#include "preprocess/surfaces/marching_cubes.h"

#include <algorithm>
#include <mutex>

#include <vtkCellArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkUnsignedCharArray.h>

namespace splatlas {
namespace {

/// VTK sets up its list of factories on the first use, and knows no other thread while it does.
void prepare_vtk() {
  static std::once_flag once;
  std::call_once(once, [] { vtkObjectFactory::GetRegisteredFactories(); });
}

}  // namespace

FittedSurface marching_cubes(const StructureCrop& crop) {
  prepare_vtk();
  vtkNew<vtkUnsignedCharArray> voxels;
  // VTK reads the crop's own memory (the 1: it must not free it) and does not write to it.
  voxels->SetArray(const_cast<std::uint8_t*>(crop.inside.data()), static_cast<vtkIdType>(crop.inside.size()),
                   1);
  vtkNew<vtkImageData> image;
  image->SetDimensions(static_cast<int>(crop.size[0]), static_cast<int>(crop.size[1]),
                       static_cast<int>(crop.size[2]));
  image->GetPointData()->SetScalars(voxels);

  vtkNew<vtkFlyingEdges3D> filter;
  filter->SetInputData(image);
  filter->SetValue(0, 0.5);
  filter->ComputeNormalsOff();
  filter->ComputeGradientsOff();
  filter->ComputeScalarsOff();
  filter->Update();
  vtkPolyData* const output = filter->GetOutput();

  FittedSurface surface;
  surface.positions_ijk.resize(static_cast<std::size_t>(output->GetNumberOfPoints()));
  for (std::size_t v = 0; v < surface.positions_ijk.size(); ++v) {
    const double* const at = output->GetPoint(static_cast<vtkIdType>(v));
    for (std::size_t a = 0; a < 3; ++a) {
      surface.positions_ijk[v][a] = static_cast<float>(at[a] + static_cast<double>(crop.first[a]));
    }
  }
  surface.triangles.reserve(static_cast<std::size_t>(output->GetNumberOfPolys()));
  vtkCellArray* const cells = output->GetPolys();
  for (vtkIdType t = 0; t < cells->GetNumberOfCells(); ++t) {
    vtkIdType corners = 0;
    const vtkIdType* ids = nullptr;
    cells->GetCellAtId(t, corners, ids);
    surface.triangles.push_back({static_cast<std::uint32_t>(ids[0]), static_cast<std::uint32_t>(ids[1]),
                                 static_cast<std::uint32_t>(ids[2])});
  }
  return surface;
}

}  // namespace splatlas
