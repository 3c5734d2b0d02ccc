// Polygons with vertex normals, as VTK data.
#pragma once

#include <span>

#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

namespace splatlas {

/// Points in single precision; normals of all points or of none.
struct PolygonMesh {
  vtkNew<vtkPoints> points;
  vtkNew<vtkFloatArray> normals;
  vtkNew<vtkCellArray> polygons;

  PolygonMesh() { normals->SetNumberOfComponents(3); }
  /// Adds a polygon; ignores points and lines (fewer than three corners).
  void add_polygon(std::span<const vtkIdType> corners) {
    if (corners.size() >= 3) polygons->InsertNextCell(static_cast<vtkIdType>(corners.size()), corners.data());
  }
  [[nodiscard]] vtkSmartPointer<vtkPolyData> poly_data() const {
    const auto data = vtkSmartPointer<vtkPolyData>::New();
    data->SetPoints(points);
    data->SetPolys(polygons);
    if (normals->GetNumberOfTuples() > 0) data->GetPointData()->SetNormals(normals);
    return data;
  }
};

}  // namespace splatlas
