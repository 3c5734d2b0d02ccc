// Writer of mesh files, through VTK, and verification of the written file.
#pragma once

#include <filesystem>
#include <span>

#include "format/content/grid.h"
#include "format/content/surface.h"
#include "format/io/output_file.h"
#include "preprocess/import/meshes/import_mesh.h"

namespace splatlas {

/// Output format by file extension; kUsage for unknown extensions.
[[nodiscard]] Result<MeshFormat> writable_mesh_format(const std::filesystem::path& path);

/// Writes all surfaces, in LPS mm, to one .stl, .ply, .vtk (all binary) or .obj file, up to commit_files();
/// with normals if the format supports them.
/// `grid` is the storage grid. kFailed for coordinates at which single precision cannot tell corners apart.
[[nodiscard]] Result<OutputFile> write_mesh(std::span<const SurfaceMesh> surfaces, const Grid& grid,
                                            const std::filesystem::path& path);

}  // namespace splatlas
