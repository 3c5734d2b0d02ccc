// Crossed voxel edges of a structure, linked across voxel faces, with the triangles of marching cubes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "format/derive/cell_cases.h"
#include "format/derive/structure_crop.h"

namespace splatlas {

/// Edge between a voxel and its successor along `axis`, one inside and one outside.
struct NetVertex {
  std::array<std::int32_t, 3> voxel{};  ///< grid index of the first one, from -1 on
  std::int32_t kind = 0;                ///< its axis, and kFirstIsInside

  static constexpr std::int32_t kFirstIsInside = 4;
  [[nodiscard]] std::size_t axis() const { return static_cast<std::size_t>(kind & 3); }
  [[nodiscard]] bool first_is_inside() const { return (kind & kFirstIsInside) != 0; }
  friend bool operator==(const NetVertex&, const NetVertex&) = default;
};

/// The surface of marching cubes (Lorensen and Cline 1987) without positions. Triangles are
/// counter-clockwise from outside in index space, sorted by the first boundary voxel of their cell (see
/// SurfaceMesh), then by cell in memory order, then as in CellCase. Vertices are numbered by first use.
struct SurfaceNet {
  std::vector<NetVertex> vertices;
  /// [vertex][slot of CellCase::Link]: the neighbour; the vertex itself in ambiguous faces.
  std::vector<std::array<std::uint32_t, 4>> neighbours;
  std::vector<std::uint8_t> kinds;  ///< [vertex]: LinkKind of its slots, two bits each, slot 0 lowest
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Threads keep the memory of nets up to this size for their next one: about 100 bytes per vertex. New pages
/// cost as much time as the work in them.
inline constexpr std::size_t kMaxKeptVertices = std::size_t{1} << 18;

/// The net of a crop of a whole structure, in the memory of `reused`. Cost: linear in the voxels of the crop,
/// an eighth of a byte each, and about 20 ns per triangle.
[[nodiscard]] SurfaceNet surface_net(const StructureCrop& crop, SurfaceNet reused = {});

}  // namespace splatlas
