// Transfer functions: from a selection's words to curves over grey values.
#pragma once

#include "format/atlas_content.h"
#include "format/selection.h"
#include "format/transfer_curve.h"

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
/// profile's default; at most kMaxVolumeOpacity. 0 where a curve is clear all over, whatever the selection
/// says.
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

}  // namespace splatlas
