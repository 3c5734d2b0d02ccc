// Light of the voxels of a volume by the gradients of their grey values, and its kernels; sums over the
// voxels of a block, for the means of drafts.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "format/content/grid.h"
#include "format/content/unit_vector.h"
#include "format/tasks/thread_pool.h"
#include "player/render/decode/class_cache.h"
#include "player/render/decode/lit_voxels.h"
#include "player/render/transfer/shading.h"
#include "player/render/transfer/transfer_table.h"
#include "player/render/transfer/volume_appearances.h"

namespace splatlas {

/// Kernels process whole vectors of at most as many lanes.
inline constexpr std::size_t kLightPadding = 16;

/// Nine rows of voxels, (slice - 1) * 3 + (row - 1), from one position on. One more is readable before.
struct GreyRows {
  std::array<const float*, 9> values;
  std::array<const std::int32_t*, 9> structures;
  std::int32_t structure;  ///< of the voxels that count
};

/// Weighted sums over pairs of neighbours along an axis, by position.
struct PairSums {
  float *pairs, *differences, *squares;
};

/// Units of gradients.
struct GradientScale {
  std::array<std::array<float, 3>, 3> to_lps{};  ///< of those along the scanline, the rows and the slices
  std::array<float, 3> per_mm_squared{};         ///< along them
  float reach_mm = 0;
};

/// Gradients of a row of voxels.
struct GradientRow {
  std::array<float*, 3> direction;  ///< in LPS, of any length
  float* coherence;                 ///< 0 for noise to 1
  float* reach;                     ///< change of the grey value over the reach
};

/// Light of a row of voxels.
struct LightRow {
  PackedNormal* normals;
  std::uint16_t* lit;
};

/// Consecutive blocks of spans.
struct UnlitBlocks {
  std::uint32_t first = 0, count = 0;   ///< numbers in their slice
  int emissions = 3;                    ///< 1 or 3
  const float* optics = nullptr;        ///< of the first one; aligned to cache lines
  std::span<const BlockLights> lights;  ///< of some of them, by ascending block
};

struct LightKernels {
  /// The weighted means of the differences of pairs of voxels of the structure in the 3x3x3 voxels around
  /// each one. `sums`: three axes, of `count` + 2 positions; overwritten.
  void (*gradient)(const GreyRows& rows, std::size_t count, const GradientScale& scale,
                   const std::array<PairSums, 3>& sums, const GradientRow& out);
  /// Extinctions below and above grey values, by their reach. Linear between whole numbers.
  void (*extinctions)(const TransferTable::View& table, const float* greys, const float* reach,
                      std::size_t count, float* below, float* above);
  /// Lights voxels in place. All-lit ones are borders: their label's normal gives way to the gradient as far
  /// as both have one direction. Others are lit where the extinctions around the grey value differ.
  void (*light)(const float* below, const float* above, std::size_t count, const GradientRow& gradients,
                const LightRow& voxels);
  /// Copies blocks to `lit`. Multiplies the lit part of emissions by `factors`: 65536, by packed normal.
  void (*emit)(const UnlitBlocks& blocks, const float* factors, float* lit);
};

/// For the best instruction set of the machine, with equal bits on all.
[[nodiscard]] LightKernels light_kernels();

/// Lights the voxels of a plan's volume classes in `cache`, unless they are lit as the plan draws them
/// (docs/model.md, "Hybrid shading"): borders by their normals and the gradient of the grey values within the
/// structure that they are drawn as, others by this gradient and their transfer function. The light of a
/// class depends on no other structure. `cache` must hold the classes with normals; nothing happens without
/// values. Cost: about 15 ns per voxel that is lit anew. Slices in parallel.
void light_voxels(const DrawPlan& plan, const VolumeAppearances& appearances, const ClassTable& classes,
                  const Grid& grid, ClassCache& cache, ThreadPool& pool);

/// Sums of optical properties of voxels (1/mm), and of their normals, weighted by the emission they light.
struct VoxelSums {
  float extinction = 0;
  std::array<float, 3> emission{};
  float weight = 0, lit = 0;  ///< of the emission: all of it, and its lit part
  std::array<float, 3> normal{};

  /// Adds a voxel, weighted by its emission.
  void add(float of_extinction, const std::array<float, 3>& of_emission, const VoxelLight& light,
           const UnpackedNormals& unpacked) {
    const float of_weight = of_emission[0] + of_emission[1] + of_emission[2];
    extinction += of_extinction;
    weight += of_weight;
    for (std::size_t c = 0; c < 3; ++c) emission[c] += of_emission[c];
    if (light.lit > 0)
      add_light(of_weight * static_cast<float>(light.lit) / VoxelLight::kAllLit, light.normal, unpacked);
  }
  /// Adds the lit emission of a voxel, in the unit of `weight`.
  void add_light(float emission_lit, PackedNormal of_voxel, const UnpackedNormals& unpacked) {
    lit += emission_lit;
    normal[0] += emission_lit * unpacked.x[of_voxel];
    normal[1] += emission_lit * unpacked.y[of_voxel];
    normal[2] += emission_lit * unpacked.z[of_voxel];
  }
  /// The colour whose product with the weight is the emission.
  [[nodiscard]] std::array<float, 3> color() const {
    if (weight <= 0) return {};
    return {emission[0] / weight, emission[1] / weight, emission[2] / weight};
  }
  /// Share of the emission that is lit, as VoxelLight::lit.
  [[nodiscard]] std::uint16_t lit_share() const {
    const float share = weight > 0 ? std::min(lit / weight, 1.0f) : 0;
    return static_cast<std::uint16_t>(std::lround(share * VoxelLight::kAllLit));
  }
};

}  // namespace splatlas
