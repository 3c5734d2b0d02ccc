// Appearances at a mesh file before VTK does: its readers believe every count and every index.
#pragma once

#include <filesystem>

#include "format/result.h"

namespace splatlas {

enum class MeshFormat { kStl, kObj, kPly, kVtk };

/// By the file's ending: .stl, .obj, .ply, .vtk. kFailed for any other.
[[nodiscard]] Result<MeshFormat> mesh_format(const std::filesystem::path& path);

/// Refuses what is not a regular file, does not start as its type does, holds less than its counts need (STL,
/// PLY), or names corners that do not exist (OBJ). Cost: OBJ and PLY are read once, of others the header.
[[nodiscard]] Result<void> check_mesh_file(const std::filesystem::path& path);

}  // namespace splatlas
