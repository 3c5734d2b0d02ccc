// Readers of PLY, OBJ and GIFTI polygons. In damaged text, VTK takes words for 0 and parts of words for
// corners in PLY and OBJ; gifti_io fills short arrays with zeros.
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

#include "format/result.h"

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

/// Reads vertices (x, y, z, optionally nx, ny, nz) and faces (vertex_indices or vertex_index) of a text or
/// binary PLY file. kFailed for headers without these properties, faces of more than 255 corners, faces
/// before the vertices, invalid corner indices, and truncated files. One pass; memory as the file.
[[nodiscard]] Result<vtkSmartPointer<vtkPolyData>> read_ply(const std::filesystem::path& path);

/// Reads vertices, normals and faces of a Wavefront OBJ file, without texture coordinates, lines and
/// materials. Splits vertices if corners have normals of their own. kFailed, with the line, for corners that
/// do not exist and vertices without three numbers. Cost: one pass; memory in proportion to the file.
[[nodiscard]] Result<vtkSmartPointer<vtkPolyData>> read_obj(const std::filesystem::path& path);

/// Reads the points and triangles of a GIFTI surface (.gii), in RAS mm: ASCII, base64 and compressed arrays.
/// Points are those of the scanner if the file has a matrix for it. FreeSurfer's move by the centre of their
/// volume. kFailed without points or triangles (labels, time series), for external arrays, and for damage.
[[nodiscard]] Result<vtkSmartPointer<vtkPolyData>> read_gifti(const std::filesystem::path& path);

}  // namespace splatlas
