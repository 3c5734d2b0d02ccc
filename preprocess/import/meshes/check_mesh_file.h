// Checks of mesh files before they are read.
#pragma once

#include <filesystem>

#include "format/result.h"

namespace splatlas {

enum class MeshFormat { kStl, kObj, kPly, kVtk };

/// The format by the file's ending: .stl, .obj, .ply, .vtk. kFailed for any other.
[[nodiscard]] Result<MeshFormat> mesh_format(const std::filesystem::path& path);

/// Checks a mesh file for errors that VTK's readers ignore. kFailed for anything but a regular file, for STL
/// and VTK files without a valid header, and for fewer triangles than an STL header declares. Cost: reads the
/// header.
[[nodiscard]] Result<void> check_mesh_file(const std::filesystem::path& path);

}  // namespace splatlas
