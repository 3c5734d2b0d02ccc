// Draco (Galligan et al. 2017) as a peer for surface compression.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "format/content/surface.h"
#include "format/result.h"

namespace splatlas::draco_peer {

struct Settings {
  int position_bits = 11;  ///< relative to the bounding box of the surface
  int normal_bits = 0;     ///< per side of the octahedral map; 0: without normals
};

/// The Draco file of a surface: edgebreaker connectivity, smallest setting (speed 0). Empty without
/// triangles. Thread-safe.
[[nodiscard]] Result<std::vector<std::byte>> encode(const SurfaceMesh& mesh, const Settings& settings);

/// Decodes such a file and returns its number of triangles.
[[nodiscard]] Result<std::uint64_t> decode(std::span<const std::byte> file);

}  // namespace splatlas::draco_peer
