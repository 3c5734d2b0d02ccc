// Marching cubes on binary masks (Lorensen and Cline 1987).
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "format/derive/structure_crop.h"
#include "format/surface.h"

namespace splatlas {

/// An edge of a cell from `corner` along `axis`. Bit a of `corner` is its coordinate (0 or 1) along axis a.
struct CellEdge {
  std::uint8_t corner = 0, axis = 0;
  friend bool operator==(const CellEdge&, const CellEdge&) = default;
};

/// Triangles of a cell with inside corners `inside` (bit c: corner c). Vertices are edge midpoints,
/// counter-clockwise seen from outside. Without ambiguous faces this is the table of Lorensen and Cline 1987.
///   - On each face, one line separates every maximal chain of inside corners. Diagonal inside corners thus
///     stay separate, and neighbouring cells agree.
///   - Lines form loops, ordered by their lowest edge (axis, then corner).
///   - A loop becomes a fan around its first edge, from the lowest, without triangles in a face of the cell.
[[nodiscard]] std::span<const std::array<CellEdge, 3>> cell_triangles(std::uint8_t inside);

/// Extracts the closed surface of a crop with shared vertices, without normals. Triangles are
/// counter-clockwise from outside in index space; one coordinate of each position ends in .5. Triangles are
/// sorted by the first boundary voxel of their cell (see SurfaceMesh), then by cell in memory order, then as
/// in cell_triangles(). Vertices are numbered by first use. Cost: linear in the voxels of the crop and in the
/// triangles.
[[nodiscard]] SurfaceMesh marching_cubes(const StructureCrop& crop);

}  // namespace splatlas
