// Surfaces of masks by VTK, and their comparison with the surfaces that readers derive.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "format/content/grid.h"
#include "format/content/surface.h"
#include "format/derive/structure_crop.h"
#include "format/result.h"

namespace splatlas {

/// The two voxels of a vertex between them.
struct VoxelEdge {
  std::size_t axis = 0;
  Index3 low{0, 0, 0}, high{0, 0, 0};

  explicit VoxelEdge(const std::array<float, 3>& between) {
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = static_cast<std::int64_t>(std::floor(between[a]));
      if (static_cast<float>(low[a]) != between[a]) axis = a;
    }
    high = low;
    ++high[axis];
  }
};

/// Triangles with vertices between an inside and an outside voxel.
struct EdgeTriangles {
  std::vector<std::array<float, 3>> positions_ijk;  ///< continuous grid indices
  /// Counter-clockwise from outside in right-handed index axes.
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Extracts the surface of a crop of a whole structure with vtkFlyingEdges3D, which has the triangles of
/// vtkMarchingCubes in a fraction of the time. kFailed with VTK's message.
[[nodiscard]] Result<EdgeTriangles> extract_with_vtk(const StructureCrop& crop);

/// The same at the zeros of a field over the voxels of a crop, by linear interpolation. Voxels from 0 on are
/// inside. Vertices and triangles have the order of extract_with_vtk() for the mask of the inside voxels.
[[nodiscard]] Result<EdgeTriangles> extract_zeros_with_vtk(const StructureCrop& crop,
                                                           std::span<const float> field);

/// [vertex of VTK]: the vertex of `mesh`, the surface of `crop`, between the same two voxels. kFailed if
/// there is none. Cost: n log n for n vertices.
[[nodiscard]] Result<std::vector<std::uint32_t>> match_vertices(const EdgeTriangles& vtk,
                                                                const StructureCrop& crop,
                                                                const SurfaceMesh& mesh);

/// Compares the triangles of a surface by fit_surface() with those of VTK, before smoothing, as sets of
/// oriented triangles between voxel edges. If they differ, `mesh` gets those of VTK, in the order of
/// SurfaceMesh, so that the file stores it. Returns whether they agree. kFailed if VTK has a vertex between
/// two voxels that the surface does not separate. Cost: n log n for n triangles.
[[nodiscard]] Result<bool> adopt_triangles(const EdgeTriangles& vtk, const StructureCrop& crop,
                                           const Grid& grid, SurfaceMesh& mesh);

}  // namespace splatlas
