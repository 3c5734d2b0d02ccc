// Polygons in the making, and readers of OBJ, GIFTI and FreeSurfer polygons. VTK takes parts of words for
// corners in OBJ; gifti_io fills short arrays with zeros.
#pragma once

#include <filesystem>
#include <span>

#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include "format/content/grid.h"
#include "format/result.h"

namespace splatlas {

/// Points in single precision; normals of all points or of none.
struct PolygonMesh {
  vtkNew<vtkPoints> points;
  vtkNew<vtkFloatArray> normals;
  vtkNew<vtkCellArray> polygons;

  PolygonMesh() {
    normals->SetName("Normals");
    normals->SetNumberOfComponents(3);
  }
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

/// Reads vertices, normals and faces of a Wavefront OBJ file. Normals count if all corners have one: then
/// vertices are split by them. kFailed, with the line, for vertices that do not exist or lack three numbers.
/// Cost: one pass; memory in proportion to the file.
[[nodiscard]] Result<vtkSmartPointer<vtkPolyData>> read_obj(const std::filesystem::path& path);

/// Reads a triangle file of FreeSurfer (lh.pial), in RAS mm of the scanner: points move by the centre of
/// their volume, if the file has it. kFailed for truncated files.
[[nodiscard]] Result<vtkSmartPointer<vtkPolyData>> read_free_surfer(const std::filesystem::path& path);

/// Reads the points and triangles of a GIFTI surface (.gii), in RAS mm: ASCII, base64 and compressed arrays.
/// Points are those of the scanner if the file has a matrix for it. FreeSurfer's move by the centre of their
/// volume. kFailed without points or triangles (labels, time series), for external arrays, and for damage.
[[nodiscard]] Result<vtkSmartPointer<vtkPolyData>> read_gifti(const std::filesystem::path& path);

}  // namespace splatlas
