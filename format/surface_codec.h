// The surface of one structure, as bytes: integer positions and packed normals, then triangles.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "format/directory.h"
#include "format/grid.h"
#include "format/result.h"
#include "format/surface.h"

namespace splatlas {

/// What the directory tells about a surface, and its stream.
struct EncodedSurface {
  SurfaceEntry entry;
  std::vector<std::byte> bytes;
};

/// Codes a surface in a grid of `size` voxels. Everything but the normals, which are packed, comes back
/// exactly. kFailed for positions that are not multiples of 1 / position_scale or lie more than a voxel
/// beyond the outer voxel centres (where marching cubes closes a surface), for normals that are not finite or
/// not one per position, and for indices out of range.
[[nodiscard]] Result<EncodedSurface> encode_surface(const SurfaceMesh& mesh, const Index3& size);

/// Safe on bytes from strangers: every index and position is checked. kInvalidAtlas.
/// `entry` has passed check_surface_entry().
[[nodiscard]] Result<SurfaceMesh> decode_surface(std::span<const std::byte> bytes, const SurfaceEntry& entry,
                                                 const Index3& size);

/// Whether counts, scale and length of a surface can belong together. kInvalidAtlas.
[[nodiscard]] Result<void> check_surface_entry(const SurfaceEntry& entry, const Index3& size);

}  // namespace splatlas
