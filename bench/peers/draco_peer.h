// Surfaces as Draco (Galligan et al. 2017) would store them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "format/result.h"
#include "format/surface.h"

namespace splatlas::draco_peer {

struct Settings {
  int position_bits = 11;  ///< of the surface's own box
  int normal_bits = 0;     ///< a side of the octahedral map; 0: without normals
};

/// One surface's Draco file, edgebreaker connectivity, the smallest that Draco makes (its speed 0). Empty
/// without triangles. Thread-safe.
[[nodiscard]] Result<std::vector<std::byte>> encode(const SurfaceMesh& mesh, const Settings& settings);

/// Reads such a file again and gives its triangles.
[[nodiscard]] Result<std::uint64_t> decode(std::span<const std::byte> file);

}  // namespace splatlas::draco_peer
