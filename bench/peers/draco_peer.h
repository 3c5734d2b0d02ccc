// Surfaces as Draco (Galligan et al. 2017) would store them.
#pragma once

#include <cstdint>

#include "format/result.h"
#include "format/surface.h"

namespace splatlas::draco_peer {

struct Settings {
  int position_bits = 11;  ///< of the surface's own box
  int normal_bits = 0;     ///< a side of the octahedral map; 0: without normals
};

/// Bytes of one surface's Draco file, edgebreaker connectivity, the smallest that Draco makes (its speed 0).
/// 0 without triangles. Thread-safe.
[[nodiscard]] Result<std::uint64_t> encoded_bytes(const SurfaceMesh& mesh, const Settings& settings);

}  // namespace splatlas::draco_peer
