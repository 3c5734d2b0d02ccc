// Marching cubes on masks: the surface between a structure's voxels and the rest.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "format/derive/structure_crop.h"

namespace splatlas {

/// An edge of a cell, from `corner` (bit a is set where the corner lies further along axis a) along `axis`.
struct CellEdge {
  std::uint8_t corner = 0, axis = 0;
  friend bool operator==(const CellEdge&, const CellEdge&) = default;
};

/// Triangles of a cell whose corners `inside` (bit c: corner c) lie inside: corners are midpoints of edges,
/// counter-clockwise seen from outside. The table follows from rules (Lorensen and Cline 1987 for cells
/// without ambiguous faces): on each face a line cuts off every maximal chain of inside corners, so that
/// diagonal ones stay apart and neighbouring cells agree; lines join to loops; a loop becomes a fan around
/// the first of its edges, from the lowest (axis, then corner) on, from which no triangle lies in a face of
/// the cell. Loops come by their lowest edge.
[[nodiscard]] std::span<const std::array<CellEdge, 3>> cell_triangles(std::uint8_t inside);

struct MaskSurface {
  std::vector<std::array<float, 3>>
      positions_ijk;  ///< in the grid's indices; one coordinate of each ends in .5
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise from outside, in index space
};

/// Closed; equal vertices are one. Triangles are sorted as surface.h says: by the boundary voxel of smallest
/// offset in their cell, cells in memory order within that, triangles as cell_triangles() has them; vertices
/// are numbered in the order of first use. Cost: linear in the crop's voxels and the triangles.
[[nodiscard]] MaskSurface marching_cubes(const StructureCrop& crop);

}  // namespace splatlas
