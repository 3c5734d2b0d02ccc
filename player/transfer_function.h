// From grey values to light: what one voxel emits and absorbs.
#pragma once

#include <array>
#include <vector>

#include "format/atlas_content.h"
#include "format/color.h"
#include "format/decision_tree.h"
#include "format/transfer_curve.h"
#include "format/voxel_type.h"

namespace splatlas {

/// Opacities of a volume over one reference length where a selection names none: soft, thin, hard.
inline constexpr float kDefaultVolumeOpacity = 0.3f;
inline constexpr float kDefaultThinOpacity = 0.01f;
inline constexpr float kDefaultHardOpacity = 0.95f;
/// Share of a structure's colour that a voxel at the low end of a ramp shows; 1 at the high end.
inline constexpr float kDarkestShade = 0.25f;
/// Width of the step of TransferProfile::kHard, as a share of its ramp.
inline constexpr double kHardStepWidth = 0.01;

/// Opacity where the volume of a structure is densest: what the selection says, else its curve's, else its
/// profile's default; at most kMaxVolumeOpacity.
[[nodiscard]] float full_opacity(const StructureDraw& draw);

/// The transfer function of a structure's volume in grey values.
///   - a ramp rises from clear and kDarkestShade at its low end to full_opacity() and shade 1 at its high
///   end;
///     an end that the selection leaves open is the display window's, or where that lies on the wrong side of
///     the other end, as far from it as the window is wide;
///   - a ramp without width (an empty window, one that is not finite) is full everywhere: one point;
///   - a curve is taken as it is, its extinctions scaled so that it reaches the selection's opacity, if any.
/// Volumes without grey values are at the last point all over. The result passes check_curve().
[[nodiscard]] TransferCurve transfer_curve(const StructureDraw& draw, const Display& display);

/// How the volume of one structure looks at full grey value: linear light, extinction in 1/mm.
struct VolumeLook {
  std::array<float, 3> color{1, 1, 1};
  float extinction_per_mm = 0;
};

/// `opacity` is reached over `reference_length_mm` of full value: extinction = -ln(1 - opacity) / length.
[[nodiscard]] VolumeLook volume_look(const StructureDraw& draw, double reference_length_mm);

/// A ramp over a window of grey values: extinction rises from 0 at `low` to its full value at `high`, colour
/// from kDarkestShade to the structure's own. NaN counts as `low`. A structure without grey values is at full
/// value.
class GreyRamp {
 public:
  /// low < high and finite, else every value is at full value. 8- and 16-bit values are looked up in a table.
  GreyRamp(VoxelType type, double low, double high);

  /// Ramp positions in [0, 1] of `count` values (of the type given at construction): numbers `first`,
  /// `first + stride`, ... of `values`, which is not read when the type is kNone.
  void positions(const std::byte* values, std::size_t first, std::size_t stride, std::size_t count,
                 float* positions) const;
  [[nodiscard]] float position_of(double value) const;

 private:
  VoxelType type_;
  double low_, high_;
  std::vector<float> table_;  // by the value's bits, for types of up to 16 bits
};

/// Colour weight of a ramp position.
[[nodiscard]] constexpr float shade_of(float position) {
  return kDarkestShade + (1.0f - kDarkestShade) * position;
}

}  // namespace splatlas
