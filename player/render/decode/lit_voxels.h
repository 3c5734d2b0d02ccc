// Voxels whose emission depends on the view (hybrid shading), blocks of voxels in spans, and their memory.
#pragma once

#include <array>
#include <cstdint>

#include "format/content/unit_vector.h"

namespace splatlas {

/// How the emission of a voxel depends on the view.
struct VoxelLight {
  static constexpr std::uint16_t kAllLit = 65535;

  PackedNormal normal = 0;
  std::uint16_t lit = 0;  ///< share of the emission that depends on the normal, of kAllLit

  friend bool operator==(const VoxelLight&, const VoxelLight&) = default;
};

/// Voxels per block of a scanline; block 0 begins at voxel 0. The optical properties of a block are kBlock
/// extinctions (1/mm), then kBlock of each emission (1/mm): one stream of memory for SIMD. Volumes of one
/// colour have one emission, that of white (extinction * shade); others have red, green and blue.
inline constexpr int kBlockBits = 4;
inline constexpr std::int64_t kBlock = std::int64_t{1} << kBlockBits;

/// The lights of the voxels of a block. Voxels of unlisted blocks have light 0.
struct BlockLights {
  std::uint32_t block = 0;  ///< number in its slice
  std::array<VoxelLight, kBlock> lights{};
};

/// Consecutive blocks of a scanline with selected voxels. Other voxels have zero extinction and emission. The
/// last voxel of a span is always zero, so that its last footprint ends within the span.
struct Span {
  std::uint32_t first_block = 0, blocks = 0;
  std::uint32_t voxels = 0;  ///< voxels with positive extinction
  std::uint32_t offset = 0;  ///< of the first block in the slice's optical properties, in blocks
};

/// Upper bound of the size of a model of `voxels` selected voxels in `runs` runs, without row offsets.
[[nodiscard]] inline std::uint64_t span_model_bytes(std::uint64_t voxels, std::uint64_t runs) {
  // Worst case: all voxels are lit, and every run is a span whose two end blocks are almost empty.
  // Transparent voxels split a span only at whole blocks, which saves memory.
  constexpr std::uint64_t kVoxel =
      4 * sizeof(float) + sizeof(BlockLights) / static_cast<std::uint64_t>(kBlock) + 1;
  return voxels * kVoxel + runs * (2 * kBlock * kVoxel + sizeof(Span));
}

}  // namespace splatlas
