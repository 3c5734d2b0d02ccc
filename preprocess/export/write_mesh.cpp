#include "preprocess/export/write_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <vtkOBJWriter.h>
#include <vtkPolyDataWriter.h>
#include <vtkSTLWriter.h>

#include "format/result_macros.h"
#include "format/tasks/task_control.h"
#include "preprocess/import/meshes/polygon_readers.h"
#include "preprocess/import/quiet_vtk.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

vtkSmartPointer<vtkPolyData> to_polygons(std::span<const SurfaceMesh> surfaces, const Grid& grid) {
  const Affine to_mm = index_to_lps_mm(grid);
  PolygonMesh mesh;
  TaskPace pace;
  for (const SurfaceMesh& surface : surfaces) {
    const vtkIdType first = mesh.points->GetNumberOfPoints();
    for (std::size_t v = 0; v < surface.positions_ijk.size(); ++v) {
      pace.step();
      const auto& [i, j, k] = surface.positions_ijk[v];
      mesh.points->InsertNextPoint(to_mm.apply({i, j, k}).data());
      mesh.normals->InsertNextTuple(surface.normals_lps[v].data());
    }
    for (const auto& [a, b, c] : surface.triangles)
      pace.step(), mesh.add_polygon(std::array{first + a, first + b, first + c});
  }
  return mesh.poly_data();
}

template <typename Writer>
bool write_with(vtkPolyData& polygons, const fs::path& path) {
  vtkNew<Writer> writer;
  writer->SetInputData(&polygons);
  writer->SetFileName(path.c_str());
  if constexpr (requires { writer->SetFileTypeToBinary(); }) writer->SetFileTypeToBinary();
  return update_quietly(*writer).empty();
}

template <typename T>
void append(T value, std::vector<std::byte>& bytes) {
  const auto raw = std::as_bytes(std::span(&value, 1));
  bytes.insert(bytes.end(), raw.begin(), raw.end());
}

/// Binary PLY; false if bytes are lost. VTK's writer appends ".ply" to names; to memory it writes nothing.
Result<bool> write_ply(vtkPolyData& polygons, OutputFile& file) {
  const std::string header = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\n"
      "property float z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
      polygons.GetNumberOfPoints(), polygons.GetNumberOfPolys());
  SPLATLAS_RETURN_IF_ERROR(file.write(std::as_bytes(std::span(header))));
  std::vector<std::byte> bytes;
  TaskPace pace;
  for (vtkIdType p = 0; p < polygons.GetNumberOfPoints(); ++p, pace.step()) {
    for (const double mm : std::span(polygons.GetPoint(p), 3)) append(static_cast<float>(mm), bytes);
  }
  for (vtkIdType t = 0; t < polygons.GetNumberOfPolys(); ++t, pace.step()) {
    vtkIdType corners = 0;
    const vtkIdType* ids = nullptr;
    polygons.GetPolys()->GetCellAtId(t, corners, ids);
    append(static_cast<std::uint8_t>(corners), bytes);
    for (const vtkIdType id : std::span(ids, static_cast<std::size_t>(corners)))
      append(static_cast<std::int32_t>(id), bytes);
  }
  SPLATLAS_RETURN_IF_ERROR(file.write(bytes));
  std::error_code error;
  return fs::file_size(file.temporary(), error) == header.size() + bytes.size();
}

/// Returns VTK's success.
Result<bool> write_as(MeshFormat format, vtkPolyData& polygons, OutputFile& file) {
  switch (format) {
    case MeshFormat::kStl: return write_with<vtkSTLWriter>(polygons, file.temporary());
    case MeshFormat::kObj: return write_with<vtkOBJWriter>(polygons, file.temporary());
    case MeshFormat::kPly: return write_ply(polygons, file);
    default: break;  // writable_mesh_format() refuses all but VTK's
  }
  return write_with<vtkPolyDataWriter>(polygons, file.temporary());
}

double largest_coordinate_mm(vtkPolyData& polygons) {
  double largest = 0;
  for (vtkIdType p = 0; p < polygons.GetNumberOfPoints(); ++p) {
    for (const double mm : std::span(polygons.GetPoint(p), 3))
      largest = std::abs(mm) > std::abs(largest) ? mm : largest;
  }
  return largest;
}

/// Distance of the numbers of single precision around a coordinate.
double rounding_step_mm(double mm) {
  const float size = std::abs(static_cast<float>(mm));
  return static_cast<double>(std::nextafter(size, HUGE_VALF)) - static_cast<double>(size);
}

/// Surfaces have positions in 1/256 voxel: up to the limit, single precision tells them apart.
tl::unexpected<Error> too_far(const fs::path& path, double largest_mm, double edge_mm) {
  constexpr double kStepsPerVoxel = 256, kStepsPerNumber = 1 << 23;
  const double limit_mm = std::min(kMaxMeshMm, edge_mm * kStepsPerNumber / kStepsPerVoxel);
  return bad_file(
      path,
      "has a coordinate of {:.6g} mm; surfaces of voxels of {:.3g} mm can always be written up to {:.6g} mm. "
      "Build from images with an origin nearer to 0",
      largest_mm, edge_mm, limit_mm);
}

}  // namespace

Result<MeshFormat> writable_mesh_format(const fs::path& path) {
  Result<MeshFormat> format = mesh_format(path);
  if (!format) {
    format.error().code = ErrorCode::kUsage;
  } else if (*format >= MeshFormat::kVtp) {
    return fail(ErrorCode::kUsage, "{}: is not written; surfaces are written as .stl, .obj, .ply or .vtk",
                path.string());
  }
  return format;
}

Result<OutputFile> write_mesh(std::span<const SurfaceMesh> surfaces, const Grid& grid, const fs::path& path) {
  SPLATLAS_ASSIGN_OR_RETURN(const MeshFormat format, writable_mesh_format(path));
  const vtkSmartPointer<vtkPolyData> polygons = to_polygons(surfaces, grid);
  const double largest_mm = largest_coordinate_mm(*polygons), edge_mm = std::ranges::min(grid.spacing_mm);
  constexpr double kMaxStep = 0.25;  // voxels
  if (std::abs(largest_mm) > kMaxMeshMm || rounding_step_mm(largest_mm) > kMaxStep * edge_mm)
    return too_far(path, largest_mm, edge_mm);
  SPLATLAS_ASSIGN_OR_RETURN(OutputFile file, OutputFile::create(path));
  SPLATLAS_ASSIGN_OR_RETURN(const bool written, write_as(format, *polygons, file));
  // Read back: VTK detects a full disk only for some formats, and lost bytes for none.
  const auto back = read_mesh_here(file.temporary(), format);
  const auto triangles = static_cast<std::size_t>(polygons->GetNumberOfPolys());
  if (written && back && back->mesh.triangles.size() + back->mesh.dropped == triangles) return file;
  return bad_file(path, "cannot be written whole; is the disk full?");
}

}  // namespace splatlas
