// Readers of PLY and OBJ polygons. VTK's own readers trust the counts and indices of a file.
#pragma once

#include <filesystem>

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include "format/result.h"

namespace splatlas {

/// Reads vertices (x, y, z, optionally nx, ny, nz) and faces (vertex_indices or vertex_index) of a text or
/// binary PLY file. kFailed for headers without these properties, faces of more than 255 corners, faces
/// before the vertices, invalid corner indices, and truncated files. Cost: one pass; memory in proportion
/// to the file.
[[nodiscard]] Result<vtkSmartPointer<vtkPolyData>> read_ply(const std::filesystem::path& path);

/// Reads vertices, normals and faces of a Wavefront OBJ file, without texture coordinates, lines and
/// materials. Splits vertices if corners have normals of their own. kFailed, with the line, for corners that
/// do not exist and vertices without three numbers. Cost: one pass; memory in proportion to the file.
[[nodiscard]] Result<vtkSmartPointer<vtkPolyData>> read_obj(const std::filesystem::path& path);

}  // namespace splatlas
