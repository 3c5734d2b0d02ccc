// How a march with a tolerance spends its steps, in vectors as ray by ray.
#pragma once

#include <cstddef>
#include <cstdint>

#include "player/rays/march_kernels.h"

namespace splatlas {

/// Whether slabs are cut from cell to cell where it pays, not evenly: grey values of bytes with one transfer
/// function and one colour, where one step is enough elsewhere.
[[nodiscard]] inline bool cuts_cells(const MarchScene& scene) {
  return scene.tolerance > 0 && scene.min_steps == 1 && scene.sources.size() == 1 &&
         scene.sources[0].cell_corners != nullptr && scene.sources[0].colors == nullptr;
}

/// How a slab that may be cut is passed.
enum class SlabMethod : std::uint8_t {
  kStraight,  ///< in one step, the grey value on a straight line
  kBent,      ///< in one step, its mean by Simpson's rule: where the transfer function is all but linear
  kCut,       ///< cell by cell: where the grey value is a cubic, halved until it is straight enough
};

// What a slab or a part of it may be wrong by, in tolerances. All is what is seen through, times the length,
// times the part of the extinction's variation that counts:
inline constexpr float kMaxVariation = 3;  ///< kBent: all of it
inline constexpr float kMaxKinks = 1;      ///< kBent: what it is off a straight line, halfway
/// A part of a cell: as much as shifting the grey value by its distance from a straight line moves.
inline constexpr float kMaxShift = 0.7f;
inline constexpr int kMaxHalvings = 5;
/// What is seen of a stride of slabs, in tolerances, below which it is one step.
inline constexpr float kFaintShare = 0.02f;

/// The extinction at both ends of a step together, of its mean: at least so much tells where in it the light
/// is.
inline constexpr float kMinEnds = 1e-3f;

/// What a step of a slab that is cut evenly may be wrong by, in tolerances: nothing is known of what is in
/// between.
inline constexpr float kEvenShare = 0.65f;

/// Simpson's rule: share of a middle's height above the chord that is the mean's.
inline constexpr float kSimpson = 2.0f / 3;

}  // namespace splatlas
