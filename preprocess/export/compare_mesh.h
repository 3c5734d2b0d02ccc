// Verification of written mesh files.
#pragma once

#include <array>
#include <span>

#include "preprocess/import/meshes/import_mesh.h"

namespace splatlas {

/// Corners of a triangle, LPS mm.
using Corners = std::array<Vec3, 3>;

/// True if the file contains the written triangles in order, within the precision of text files. Degenerate
/// triangles, which importers drop, may be missing.
[[nodiscard]] bool holds_triangles(const TriangleMesh& file, std::span<const Corners> written);

}  // namespace splatlas
