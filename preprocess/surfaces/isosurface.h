// Isosurfaces of grey values.
#pragma once

#include "format/content/grid.h"
#include "format/content/surface.h"
#include "format/content/voxel_type.h"
#include "format/derive/structure_crop.h"
#include "preprocess/surfaces/vtk_surface.h"

namespace splatlas {

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
/// voxel of the crop. Cost: that of match_vertices(), and about 1 us per vertex for normals.
[[nodiscard]] Result<void> move_to_isosurface(const VoxelBuffer& values, double level,
                                              const StructureCrop& crop, const Grid& grid,
                                              const EdgeTriangles& vtk, SurfaceMesh& mesh);

}  // namespace splatlas
