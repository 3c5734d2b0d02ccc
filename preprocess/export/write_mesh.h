// Writes surfaces through VTK.
#pragma once

#include <filesystem>
#include <span>

#include "format/grid.h"
#include "format/surface.h"
#include "preprocess/import/meshes/check_mesh_file.h"

namespace splatlas {

/// By the ending of a file that is to be written; kUsage for endings of unknown types.
[[nodiscard]] Result<MeshFormat> writable_mesh_format(const std::filesystem::path& path);

/// Writes the surfaces, in LPS mm, into one .stl, .ply, .vtk (all binary) or .obj file, with normals where
/// the format has them; whole or not at all. `grid` is the storage grid.
[[nodiscard]] Result<void> write_mesh(std::span<const SurfaceMesh> surfaces, const Grid& grid,
                                      const std::filesystem::path& path);

}  // namespace splatlas
