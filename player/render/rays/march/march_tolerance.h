// Step control of ray marching with an error tolerance.
#pragma once

#include <cstdint>

#include "player/render/rays/march_kernels.h"

namespace splatlas {

/// True if slabs are subdivided by cells, not evenly: for byte grey values with one transfer function
/// and one colour, as long as one step per slab is allowed.
[[nodiscard]] inline bool subdivides_cells(const MarchScene& scene) {
  return scene.tolerance > 0 && scene.min_steps == 1 && scene.sources.size() == 1 &&
         scene.sources[0].cell_corners != nullptr && scene.sources[0].colors == nullptr;
}

/// Integration of a slab, chosen for all rays of a packet together.
enum class SlabMethod : std::uint8_t {
  kLinear,     ///< one step, grey value linear
  kSimpson,    ///< one step, mean grey value by Simpson's rule: the transfer function is nearly linear
  kSubdivide,  ///< cell by cell, the cubic subdivided until it is straight enough
};

// Error bounds of a slab or a part of it, in tolerances. All are multiplied by transmittance, segment length
// and the relevant part of the extinction's variation.
inline constexpr float kMaxVariation = 3;  ///< kSimpson: total variation
inline constexpr float kMaxKinks = 1;      ///< kSimpson: distance from a straight line at the middle
/// Part of a cell: the effect of shifting the grey value by its distance from the chord.
inline constexpr float kMaxShift = 0.7f;
inline constexpr int kMaxSubdivisions = 5;
/// Weight of several slabs, in tolerances, below which one step integrates them all.
inline constexpr float kFaintShare = 0.02f;

/// Lower bound of the sum of the extinctions at both ends of a segment, in mean extinctions of the segment.
/// The slope of the colour along the segment is divided by this sum.
inline constexpr float kMinEnds = 1e-3f;

/// Error bound of a step in a slab that is divided evenly, in tolerances: the field in between is unknown.
inline constexpr float kEvenShare = 0.65f;

/// Simpson's rule: mean height above the chord as a share of the height at the middle.
inline constexpr float kSimpsonShare = 2.0f / 3;

}  // namespace splatlas
