// Surfaces of masks by VTK, and their comparison with the surfaces that readers derive.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "format/derive/structure_crop.h"
#include "format/grid.h"
#include "format/result.h"
#include "format/surface.h"

namespace splatlas {

/// Triangles with vertices midway between an inside and an outside voxel.
struct MidwayTriangles {
  std::vector<std::array<float, 3>> positions_ijk;  ///< continuous grid indices
  /// Counter-clockwise from outside in right-handed index axes.
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Extracts the surface of a crop of a whole structure with vtkFlyingEdges3D, which has the triangles of
/// vtkMarchingCubes in a fraction of the time. kFailed with VTK's message.
[[nodiscard]] Result<MidwayTriangles> extract_with_vtk(const StructureCrop& crop);

/// Compares the triangles of a surface by fit_surface() with those of VTK, before smoothing, as sets of
/// oriented triangles between voxel edges. If they differ, `mesh` gets those of VTK, in the order of
/// SurfaceMesh, so that the file stores it. Returns whether they agree. kFailed if VTK has a vertex between
/// two voxels that the surface does not separate. Cost: n log n for n triangles.
[[nodiscard]] Result<bool> adopt_triangles(const MidwayTriangles& vtk, const StructureCrop& crop,
                                           const Grid& grid, SurfaceMesh& mesh);

}  // namespace splatlas
