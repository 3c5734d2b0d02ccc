// Normal-guided relaxation of a surface net along its voxel edges ("smoothing 1").
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "format/derive/surface_net.h"

namespace splatlas {

/// Positions and directions of the vertices of a net.
struct SmoothedNet {
  static constexpr std::int32_t kScale = 256;
  std::vector<std::uint8_t> offsets;  ///< from the first voxel along the edge, in 1 / kScale voxel; 16 to 240
  /// Outwards in index axes, of any length but 0. The fourth element is 0.
  std::vector<std::array<std::int32_t, 4>> directions;
};

/// Smooths a net by 16 steps of averaging of area vectors and 8 steps of relaxation, docs/atlas_surfaces.md.
/// Integers only: the same bits on every machine, whatever the numbering of the vertices. Mirrored and
/// complementary masks have mirrored and opposite results. The result is in the memory of `reused`. Cost:
/// about 60 ns and 80 bytes per vertex.
[[nodiscard]] SmoothedNet smooth(const SurfaceNet& net, SmoothedNet reused = {});

}  // namespace splatlas
