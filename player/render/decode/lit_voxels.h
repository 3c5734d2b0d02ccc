// Voxels whose emission depends on the view (hybrid shading), blocks of voxels in spans, and their memory.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

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

/// The lit voxels of a block with one colour. Other voxels of the block have light 0.
struct LitBlock {
  std::uint32_t block = 0;             ///< number in its slice; that of a voxel is kBlock times as large
  std::array<float, 3> color{};        ///< linear; emissions are those of white times the colour
  std::array<float, kBlock> whites{};  ///< unlit emissions of white, 1/mm
  std::array<VoxelLight, kBlock> lights{};

  /// The lit emission of white of a voxel. `factors`: 65536, by packed normal.
  [[nodiscard]] float lit_white(std::size_t n, std::span<const float> factors) const {
    const float share = static_cast<float>(lights[n].lit) / VoxelLight::kAllLit;
    return whites[n] * (1 + share * (factors[lights[n].normal] - 1));
  }
};

/// The lit voxels of a slice, by ascending block.
using LitBlocks = std::vector<LitBlock>;

/// The latest block, or a new one with another number or colour. Means of one colour differ by rounding.
[[nodiscard]] inline LitBlock& require_block(LitBlocks& blocks, std::uint32_t block,
                                             const std::array<float, 3>& color) {
  const auto is_same = [](float a, float b) { return std::abs(a - b) < 2e-6f; };
  if (blocks.empty() || blocks.back().block != block ||
      !std::equal(color.begin(), color.end(), blocks.back().color.begin(), is_same)) {
    LitBlock& next = blocks.emplace_back();
    next.block = block;
    next.color = color;
  }
  return blocks.back();
}

/// Finds the blocks of lit voxels by ascending number. O(1) amortised.
class LitCursor {
 public:
  explicit LitCursor(const LitBlocks& of) : next_(of.begin()), end_(of.end()) {}

  /// Null unless the voxel is lit.
  [[nodiscard]] const LitBlock* find(std::uint32_t number) {
    const std::uint32_t block = number >> kBlockBits;
    while (next_ != end_ && next_->block < block) ++next_;
    for (auto of = next_; of != end_ && of->block == block; ++of) {
      if (of->lights[number % kBlock].lit > 0) return &*of;
    }
    return nullptr;
  }

 private:
  LitBlocks::const_iterator next_, end_;
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
  constexpr std::uint64_t kVoxel = 4 * sizeof(float) + sizeof(LitBlock) / kBlock;
  return voxels * kVoxel + runs * (2 * kBlock * kVoxel + sizeof(Span));
}

}  // namespace splatlas
