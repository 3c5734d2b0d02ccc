// Lit voxels of ray volumes.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "player/render/decode/lit_voxels.h"

namespace splatlas {

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

}  // namespace splatlas
