// Mesh compression of structure surfaces: quantized positions, packed normals and triangle indices.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "format/content/grid.h"
#include "format/content/surface.h"
#include "format/result.h"

namespace splatlas {

/// Directory entry of a surface.
struct SurfaceEntry {
  std::uint32_t vertices = 0, triangles = 0;
  std::uint32_t position_scale = 2;  ///< a SurfaceRule if fitted
  std::uint32_t bytes = 0;  ///< decoded length of the stream; 0 also for fitted surfaces, see is_fitted()
};

/// True if the surface is not stored: readers derive it from the structure's voxels by fit_surface().
[[nodiscard]] inline bool is_fitted(const SurfaceEntry& entry) {
  return entry.vertices > 0 && entry.bytes == 0;
}

/// The rule of a fitted surface.
[[nodiscard]] inline SurfaceRule rule_of(const SurfaceEntry& entry) {
  return static_cast<SurfaceRule>(entry.position_scale);
}

/// Directory entry and stream of a surface.
struct EncodedSurface {
  SurfaceEntry entry;
  std::vector<std::byte> bytes;
};

/// Encodes a surface in a grid of `size` voxels with meshoptimizer. Lossless except for the packed normals.
/// Positions must be multiples of 1 / position_scale, at most one voxel outside the outer voxel centres.
/// Normals must be finite, one per position; indices must be in range. kFailed otherwise.
[[nodiscard]] Result<EncodedSurface> encode_surface(const SurfaceMesh& mesh, const Index3& size);

/// Decodes a surface. kInvalidAtlas for invalid streams, indices or positions. Safe on untrusted bytes.
/// `entry` must pass check_surface_entry().
[[nodiscard]] Result<SurfaceMesh> decode_surface(std::span<const std::byte> bytes, const SurfaceEntry& entry,
                                                 const Index3& size);

/// kInvalidAtlas if counts, scale and stream length of a surface are inconsistent.
[[nodiscard]] Result<void> check_surface_entry(const SurfaceEntry& entry, const Index3& size);

}  // namespace splatlas
