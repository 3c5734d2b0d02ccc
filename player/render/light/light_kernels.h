// Kernels that light voxels (hot loops). Arrays are readable and writable for kLightPadding elements more.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "format/content/unit_vector.h"
#include "player/render/transfer/transfer_table.h"

namespace splatlas {

/// Kernels process whole vectors of at most as many lanes.
inline constexpr std::size_t kLightPadding = 16;

/// Nine rows of voxels, (slice - 1) * 3 + (row - 1), from one position on. One more is readable before.
struct GreyRows {
  std::array<const float*, 9> values;    ///< 0 where not selected
  std::array<const float*, 9> selected;  ///< 0 or 1
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

/// Normals of a row of voxels, and their lit shares.
struct LitRow {
  PackedNormal* normals;
  std::uint16_t* lit;
};

struct LightKernels {
  /// The weighted means of the differences of pairs of selected voxels in the 3x3x3 voxels around each one.
  /// `sums`: three axes, of `count` + 2 positions; overwritten.
  void (*gradient)(const GreyRows& rows, std::size_t count, const GradientScale& scale,
                   const std::array<PairSums, 3>& sums, const GradientRow& out);
  /// Voxels at borders: replaces the label's normal by the gradient as far as both have one direction.
  void (*boundary)(const PackedNormal* labels, std::size_t count, const GradientRow& gradients,
                   const LitRow& out);
  /// Extinctions below and above grey values, by their reach. Linear between whole numbers.
  void (*extinctions)(const TransferTable::View& table, const float* greys, const float* reach,
                      std::size_t count, float* below, float* above);
  /// Others: lit where the extinctions below and above the grey value, by its reach, differ.
  void (*interior)(const float* below, const float* above, std::size_t count, const GradientRow& gradients,
                   const LitRow& out);
};

/// For the best instruction set of the machine, with equal bits on all.
[[nodiscard]] const LightKernels& light_kernels();

}  // namespace splatlas
