#include "preprocess/export/write_mesh.h"

#include <vector>

#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkOBJWriter.h>
#include <vtkPLYWriter.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataWriter.h>
#include <vtkSTLWriter.h>

#include "format/system/result_macros.h"
#include "preprocess/export/compare_mesh.h"
#include "preprocess/export/temporary_output.h"
#include "preprocess/import/import_error.h"
#include "preprocess/import/meshes/check_mesh_file.h"
#include "preprocess/import/meshes/import_mesh.h"
#include "preprocess/import/meshes/quiet_vtk.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

vtkNew<vtkPolyData> to_polygons(std::span<const SurfaceMesh> surfaces, const Grid& grid) {
  const Affine to_mm = index_to_lps_mm(grid);
  vtkNew<vtkPoints> points;
  vtkNew<vtkFloatArray> normals;
  normals->SetName("Normals");
  normals->SetNumberOfComponents(3);
  vtkNew<vtkCellArray> triangles;
  for (const SurfaceMesh& surface : surfaces) {
    const vtkIdType first = points->GetNumberOfPoints();
    for (std::size_t v = 0; v < surface.positions_ijk.size(); ++v) {
      const auto& [i, j, k] = surface.positions_ijk[v];
      points->InsertNextPoint(to_mm.apply({i, j, k}).data());
      normals->InsertNextTuple(surface.normals_lps[v].data());
    }
    for (const auto& [a, b, c] : surface.triangles)
      triangles->InsertNextCell({first + a, first + b, first + c});
  }
  vtkNew<vtkPolyData> polygons;
  polygons->SetPoints(points);
  polygons->SetPolys(triangles);
  polygons->GetPointData()->SetNormals(normals);
  return polygons;
}

std::vector<Corners> corners_of(std::span<const SurfaceMesh> surfaces, const Grid& grid) {
  const Affine to_mm = index_to_lps_mm(grid);
  std::vector<Corners> corners;
  for (const SurfaceMesh& surface : surfaces) {
    const auto at = [&](std::uint32_t vertex) {
      const auto& [i, j, k] = surface.positions_ijk[vertex];
      return to_mm.apply({i, j, k});
    };
    for (const auto& [a, b, c] : surface.triangles) corners.push_back({at(a), at(b), at(c)});
  }
  return corners;
}

template <typename Writer>
std::string write_with(vtkPolyData& polygons, const fs::path& path) {
  vtkNew<Writer> writer;
  writer->SetInputData(&polygons);
  writer->SetFileName(path.c_str());
  if constexpr (requires { writer->SetFileTypeToBinary(); }) writer->SetFileTypeToBinary();
  return update_quietly(*writer);
}

std::string write_as(MeshFormat format, vtkPolyData& polygons, const fs::path& path) {
  switch (format) {
    case MeshFormat::kStl: return write_with<vtkSTLWriter>(polygons, path);
    case MeshFormat::kObj: return write_with<vtkOBJWriter>(polygons, path);
    case MeshFormat::kPly: return write_with<vtkPLYWriter>(polygons, path);
    case MeshFormat::kVtk: break;
  }
  return write_with<vtkPolyDataWriter>(polygons, path);
}

}  // namespace

Result<MeshFormat> writable_mesh_format(const fs::path& path) {
  Result<MeshFormat> format = mesh_format(path);
  if (!format) format.error().code = ErrorCode::kUsage;
  return format;
}

Result<void> write_mesh(std::span<const SurfaceMesh> surfaces, const Grid& grid, const fs::path& path) {
  SPLATLAS_ASSIGN_OR_RETURN(const MeshFormat format, writable_mesh_format(path));
  return write_atomically(path, [&](const fs::path& temporary) -> Result<void> {
    const vtkNew<vtkPolyData> polygons = to_polygons(surfaces, grid);
    const bool written = write_as(format, *polygons, temporary).empty();
    // Read back: VTK detects a full disk only for some formats, and lost bytes for none.
    const auto back = import_mesh(temporary, MeshFrame::kLps);
    if (!written || !back || !holds_triangles(*back, corners_of(surfaces, grid))) {
      return bad_file(path, "cannot be written whole; is the disk full?");
    }
    return {};
  });
}

}  // namespace splatlas
