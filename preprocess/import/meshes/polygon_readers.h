// Readers of PLY, OBJ and GIFTI polygons. VTK's own readers trust the counts and indices of a file.
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

/// Reads the points and triangles of a GIFTI surface (.gii), in RAS mm: ASCII, base64 and compressed arrays.
/// Points are those of the scanner if the file has a matrix for it. FreeSurfer's surfaces move by the centre
/// of their volume. kFailed for files without points or triangles (labels, time series), external arrays, and
/// damage.
[[nodiscard]] Result<vtkSmartPointer<vtkPolyData>> read_gifti(const std::filesystem::path& path);

}  // namespace splatlas
