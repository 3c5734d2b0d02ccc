// SIMD kernel of grey value prediction: weighted sums over neighbours in previous rows and slices.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace splatlas {

/// Offset of a neighbour. All neighbours precede the voxel in memory order; nearest first.
struct NeighbourOffset {
  std::int64_t i, j, k;
};
inline constexpr std::array<NeighbourOffset, 14> kNeighbours{{{0, -1, 0},
                                                              {0, 0, -1},
                                                              {1, -1, 0},
                                                              {-1, -1, 0},
                                                              {-1, 0, -1},
                                                              {0, -1, -1},
                                                              {1, 0, -1},
                                                              {0, 1, -1},
                                                              {1, -1, -1},
                                                              {-1, -1, -1},
                                                              {-1, 1, -1},
                                                              {1, 1, -1},
                                                              {0, -2, 0},
                                                              {0, 0, -2}}};
/// Number of leading neighbours with prediction errors in the context.
inline constexpr std::size_t kErrorNeighbours = 8;

/// Weights of the neighbours in units of 1 / kWeightUnit. The previous voxel has the rest of the unit.
using ValueWeights = std::array<std::int8_t, kNeighbours.size()>;
inline constexpr int kWeightBits = 6;
inline constexpr int kWeightUnit = 1 << kWeightBits;

/// Padding of the arrays: filters read and write whole vectors.
inline constexpr std::size_t kFilterPadding = 64;

/// Neighbours of a run. Negative values are absent.
template <typename Lane>
struct FilterInput {
  std::array<const Lane*, kNeighbours.size()> values;        ///< [neighbour] of the run's first voxel
  std::array<const std::uint8_t*, kErrorNeighbours> errors;  ///< [neighbour] of the run's first voxel
  std::array<Lane, kNeighbours.size()> weights;
};
/// Results per voxel of the run.
template <typename Lane>
struct FilterOutput {
  Lane* sums;            ///< weighted sum of the present neighbours, plus half a unit for rounding
  Lane* rest;            ///< kWeightUnit minus the weights of the present neighbours
  std::uint8_t* errors;  ///< sum of the errors, at most 255
};

/// Filters a run of `count` voxels. Sums wrap around in the lane type. Predictions use only bits that fit: 16
/// bits for 8-bit values, 32 bits for 16-bit values.
void filter_run(const FilterInput<std::int16_t>& input, std::size_t count,
                const FilterOutput<std::int16_t>& output);
void filter_run(const FilterInput<std::int32_t>& input, std::size_t count,
                const FilterOutput<std::int32_t>& output);

}  // namespace splatlas
