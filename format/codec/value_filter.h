// The part of a prediction of grey values that does not wait for the voxel before: sums over the neighbours
// in lines above and in slices before. Internal: the kernel of value_window.h.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace splatlas {

/// Where a voxel's neighbours are from it, the nearest first: all come before it in memory order.
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
/// Of these, the first ones also tell how well voxels around were predicted.
inline constexpr std::size_t kErrorNeighbours = 8;

/// Weights of the neighbours; what is missing to kWeightUnit is the weight of the voxel before.
using ValueWeights = std::array<std::int8_t, kNeighbours.size()>;
inline constexpr int kWeightBits = 6;
inline constexpr int kWeightUnit = 1 << kWeightBits;

/// Filters work on whole vectors: so many elements after the last may be read and written.
inline constexpr std::size_t kFilterPadding = 64;

/// A run and what is around it. Values below 0 are absent.
template <typename Lane>
struct FilterInput {
  std::array<const Lane*, kNeighbours.size()> values;        ///< [neighbour]: of the run's first voxel
  std::array<const std::uint8_t*, kErrorNeighbours> errors;  ///< likewise
  std::array<Lane, kNeighbours.size()> weights;
};
template <typename Lane>
struct FilterOutput {
  Lane* sums;            ///< [voxel]: weights times values of neighbours that are there, and half a unit
  Lane* rest;            ///< [voxel]: what their weights leave of a unit
  std::uint8_t* errors;  ///< [voxel]: sum of the errors, 255 at most
};

/// Filters a run of `count` voxels. Sums wrap around at the lane's range: 16 bits are enough for the bits
/// that predictions of 8 bit values take from them, 32 for 16 bit values.
void filter_run(const FilterInput<std::int16_t>& input, std::size_t count,
                const FilterOutput<std::int16_t>& output);
void filter_run(const FilterInput<std::int32_t>& input, std::size_t count,
                const FilterOutput<std::int32_t>& output);

}  // namespace splatlas
