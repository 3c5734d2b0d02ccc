// The surface of one structure, as bytes: integer positions and packed normals, then triangles.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "format/grid.h"
#include "format/result.h"
#include "format/surface.h"

namespace splatlas {

/// A surface as the directory records it.
struct SurfaceEntry {
  std::uint32_t vertices = 0, triangles = 0, position_scale = 2;
  std::uint32_t bytes = 0;  ///< decoded length of the surface's stream; 0 with vertices: see is_fitted()
};

/// Whether a surface is not stored: it is what fit_surface() finds from the structure's voxels.
[[nodiscard]] inline bool is_fitted(const SurfaceEntry& entry) {
  return entry.vertices > 0 && entry.bytes == 0;
}

/// A surface's directory entry and its stream.
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
