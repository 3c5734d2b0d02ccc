// Voxels whose emission depends on the view (hybrid shading), blocks of voxels in spans, and their memory.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
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

/// A voxel that is lit by its normal.
struct LitVoxel {
  float white = 0;  ///< unlit emission of white, 1/mm
  VoxelLight light;

  /// The lit emission of white, given the factor of the part that depends on the normal.
  [[nodiscard]] float lit_white(float factor) const {
    return white * (1 + static_cast<float>(light.lit) / VoxelLight::kAllLit * (factor - 1));
  }
  friend bool operator==(const LitVoxel&, const LitVoxel&) = default;
};

/// Lit voxels with consecutive numbers and one colour.
struct LitRun {
  std::uint32_t number = 0;            ///< of the first voxel in its slice
  std::uint32_t first = 0, count = 0;  ///< in LitVoxels::voxels
  std::array<float, 3> color{};        ///< linear; their emissions are those of white times the colour

  [[nodiscard]] std::uint32_t end() const { return number + count; }
  friend bool operator==(const LitRun&, const LitRun&) = default;
};

/// The lit voxels of a slice, by ascending number.
struct LitVoxels {
  std::vector<LitRun> runs;
  std::vector<LitVoxel> voxels;

  void clear() {
    runs.clear();
    voxels.clear();
  }
  /// Begins a run unless the last one goes on. `first`: index of its first voxel.
  void begin_run(std::uint32_t number, std::size_t first, const std::array<float, 3>& color) {
    if (runs.empty() || runs.back().end() != number || runs.back().color != color)
      runs.push_back({number, static_cast<std::uint32_t>(first), 0, color});
  }
  /// Appends a voxel to the last run, or to a new one behind a gap or with another colour.
  void add(std::uint32_t number, const LitVoxel& voxel, const std::array<float, 3>& color) {
    begin_run(number, voxels.size(), color);
    ++runs.back().count;
    voxels.push_back(voxel);
  }
  friend bool operator==(const LitVoxels&, const LitVoxels&) = default;
};

/// Finds lit voxels by ascending number. O(1) amortised.
class LitCursor {
 public:
  explicit LitCursor(const LitVoxels& of) : of_(&of) {}

  /// Null unless the voxel is lit. Valid until the next call, together with color().
  [[nodiscard]] const LitVoxel* find(std::uint32_t number) {
    while (run_ < of_->runs.size() && of_->runs[run_].end() <= number) ++run_;
    if (run_ == of_->runs.size() || number < of_->runs[run_].number) return nullptr;
    return &of_->voxels[of_->runs[run_].first + (number - of_->runs[run_].number)];
  }
  [[nodiscard]] const std::array<float, 3>& color() const { return of_->runs[run_].color; }

 private:
  const LitVoxels* of_;
  std::size_t run_ = 0;
};

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

/// Upper bound of the size of a model of `voxels` selected voxels in `runs` runs, without row offsets.
[[nodiscard]] inline std::uint64_t span_model_bytes(std::uint64_t voxels, std::uint64_t runs) {
  // Worst case: every second voxel is lit, and every run is a span whose two end blocks are almost empty.
  // Transparent voxels split a span only at whole blocks, which saves memory.
  constexpr std::uint64_t kOptics = 4 * sizeof(float), kLit = (sizeof(LitVoxel) + sizeof(LitRun)) / 2;
  return voxels * (kOptics + kLit) + runs * (2 * kBlock * kOptics + sizeof(Span) + kLit);
}

}  // namespace splatlas
