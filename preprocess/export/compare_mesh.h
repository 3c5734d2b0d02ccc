// Whether a mesh file holds what was written to it.
#pragma once

#include <array>
#include <span>

#include "preprocess/import/meshes/import_mesh.h"

namespace splatlas {

/// Corners of a triangle, LPS mm.
using Corners = std::array<Vec3, 3>;

/// Whether the triangles of a file are those that were written, in their order, to the digits that text files
/// have. Those without area, which importers drop, may be missing.
[[nodiscard]] bool holds_triangles(const TriangleMesh& file, std::span<const Corners> written);

}  // namespace splatlas
