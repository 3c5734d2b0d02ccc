// Writer of mesh files, through VTK.
#pragma once

#include <filesystem>
#include <span>

#include "format/grid.h"
#include "format/surface.h"
#include "preprocess/import/meshes/check_mesh_file.h"

namespace splatlas {

/// Output format by file extension; kUsage for unknown extensions.
[[nodiscard]] Result<MeshFormat> writable_mesh_format(const std::filesystem::path& path);

/// Writes all surfaces, in LPS mm, to one .stl, .ply, .vtk (all binary) or .obj file, atomically; with
/// normals if the format supports them. `grid` is the storage grid.
[[nodiscard]] Result<void> write_mesh(std::span<const SurfaceMesh> surfaces, const Grid& grid,
                                      const std::filesystem::path& path);

}  // namespace splatlas
