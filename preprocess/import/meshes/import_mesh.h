// Importer of external surfaces: implants, needles, beams.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "format/grid.h"

namespace splatlas {

enum class MeshFormat { kStl, kObj, kPly, kVtk };

/// The format by the file's ending: .stl, .obj, .ply, .vtk. kFailed for any other.
[[nodiscard]] Result<MeshFormat> mesh_format(const std::filesystem::path& path);

/// Coordinate frame of mesh files.
enum class MeshFrame {
  kLps,  ///< x to the left, y to posterior, z to superior: ITK, DICOM, 3D Slicer's files
  kRas,  ///< x to the right, y to anterior
};

/// Triangles of a file, in LPS mm.
struct TriangleMesh {
  std::vector<Vec3> positions_lps_mm;
  std::vector<std::array<float, 3>> normals_lps;  ///< one per position; empty when the file has none
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::uint64_t dropped = 0;  ///< dropped triangles: zero area, or a corner that is not finite
};

/// Reads and triangulates STL, OBJ, PLY or legacy VTK polygons, by the file's ending. kFailed, in one line,
/// for files that are missing, truncated or of another type, for invalid corner indices, and without
/// triangles. Prints nothing. VTK reads STL and VTK files only: its readers of OBJ and PLY trust counts and
/// indices.
[[nodiscard]] Result<TriangleMesh> import_mesh(const std::filesystem::path& path, MeshFrame frame);
/// The same for a file of any name.
[[nodiscard]] Result<TriangleMesh> import_mesh(const std::filesystem::path& path, MeshFormat format,
                                               MeshFrame frame);

/// Vertex normals: area-weighted means of the adjacent triangles' normals.
[[nodiscard]] std::vector<std::array<float, 3>> vertex_normals(const TriangleMesh& mesh);

}  // namespace splatlas
