// Blocks of voxels in spans, and the memory that spans take.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "format/content/unit_vector.h"

namespace splatlas {

/// Voxels per block of a scanline; block 0 begins at voxel 0. The optical properties of a block are kBlock
/// extinctions (1/mm), then kBlock of each emission (1/mm): one stream of memory for SIMD. Volumes of one
/// colour have one emission, that of white (extinction * shade); others have red, green and blue.
inline constexpr int kBlockBits = 4;
inline constexpr std::int64_t kBlock = std::int64_t{1} << kBlockBits;

/// Consecutive blocks of a scanline with selected voxels. Other voxels have zero extinction and emission. The
/// last voxel of a span is always zero, so that its last footprint ends within the span.
struct Span {
  std::uint32_t first_block = 0, blocks = 0;
  std::uint32_t voxels = 0;  ///< voxels with positive extinction
  std::uint32_t offset = 0;  ///< of the first block in the slice's optical properties, in blocks
};

/// A voxel that is shaded by its normal, so that its emission depends on the view (hybrid shading).
struct ShadedVoxel {
  /// `lit` of voxels whose whole emission depends on the normal.
  static constexpr std::uint16_t kAllLit = 65535;

  std::size_t place = 0;  ///< of its extinction: SliceSpans::place()
  PackedNormal normal = 0;
  std::uint16_t lit = kAllLit;      ///< share of the emission that depends on the normal
  std::array<float, 3> emission{};  ///< unshaded, 1/mm; only the first is used for volumes of one colour
};

/// The factor of the emission of a voxel, given that of its lit part.
[[nodiscard]] inline float lit_factor(float factor, std::uint16_t lit) {
  if (lit == ShadedVoxel::kAllLit) return factor;
  return 1 + static_cast<float>(lit) / ShadedVoxel::kAllLit * (factor - 1);
}

/// Upper bound of the size of a model of `voxels` selected voxels in `runs` runs, without row offsets.
[[nodiscard]] inline std::uint64_t span_model_bytes(std::uint64_t voxels, std::uint64_t runs) {
  // Worst case: every voxel is shaded, and every run is a span whose two end blocks are almost empty.
  // Transparent voxels split a run only at whole blocks, which saves memory.
  constexpr std::uint64_t kOptics = 4 * sizeof(float);
  return voxels * (kOptics + sizeof(ShadedVoxel)) + runs * (2 * kBlock * kOptics + sizeof(Span));
}

}  // namespace splatlas
