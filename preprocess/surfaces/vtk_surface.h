// Surfaces of masks by VTK, their comparison with the surfaces that readers derive, and isosurfaces.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "format/content/grid.h"
#include "format/content/surface.h"
#include "format/content/voxel_type.h"
#include "format/derive/structure_crop.h"
#include "format/result.h"

namespace splatlas {

/// Triangles with vertices between an inside and an outside voxel.
struct EdgeTriangles {
  std::vector<std::array<float, 3>> positions_ijk;  ///< continuous grid indices
  /// Counter-clockwise from outside in right-handed index axes.
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Extracts the surface of a crop of a whole structure with vtkFlyingEdges3D, which has the triangles of
/// vtkMarchingCubes in a fraction of the time. kFailed with VTK's message.
[[nodiscard]] Result<EdgeTriangles> extract_with_vtk(const StructureCrop& crop);

/// Compares the triangles of a surface by fit_surface() with those of VTK, before smoothing, as sets of
/// oriented triangles between voxel edges. If they differ, `mesh` gets those of VTK, in the order of
/// SurfaceMesh, so that the file stores it. Returns whether they agree. kFailed if VTK has a vertex between
/// two voxels that the surface does not separate. Cost: n log n for n triangles.
[[nodiscard]] Result<bool> adopt_triangles(const EdgeTriangles& vtk, const StructureCrop& crop,
                                           const Grid& grid, SurfaceMesh& mesh);

/// Steps per voxel of the positions of isosurfaces. No rule of derived surfaces has this scale.
inline constexpr std::uint32_t kIsosurfaceScale = 1024;
/// Maximum size of a grid along each axis: positions are exact in single precision.
inline constexpr std::int64_t kMaxIsosurfaceSize = 16383;

/// Moves the vertices of a structure's surface to the isosurface of the grey values (Lorensen and Cline
/// 1987), as placed by VTK's linear interpolation, and turns the normals down the gradient of the grey
/// values, smoothed by a Gaussian with a sigma of 1.75 voxels. Positions are rounded to 1/1024 voxel, and
/// stay that far from the voxels. A vertex stays where the values do not cross `level` between its voxels, or
/// are not finite: at the border of the grid and of an enclosing structure, so that the surface stays closed.
/// `vtk` is extract_with_vtk(crop), `mesh` has its vertices. kFailed with VTK's message. Memory: 4 bytes per
/// voxel of the crop. Cost: n log n for n vertices, and about 1 us per vertex for normals.
[[nodiscard]] Result<void> move_to_isosurface(const VoxelBuffer& values, double level,
                                              const StructureCrop& crop, const Grid& grid,
                                              const EdgeTriangles& vtk, SurfaceMesh& mesh);

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

}  // namespace splatlas
