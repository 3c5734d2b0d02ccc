// Transfer function of a selected structure.
#pragma once

#include "format/content/atlas_content.h"
#include "format/content/selection.h"
#include "format/content/transfer_curve.h"

namespace splatlas {

/// Default opacities of a volume over one reference length, for the soft, thin and hard profiles.
inline constexpr float kDefaultVolumeOpacity = 0.3f;
inline constexpr float kDefaultThinOpacity = 0.01f;
inline constexpr float kDefaultHardOpacity = 0.95f;
/// Shade at the low end of a ramp; the shade at the high end is 1.
inline constexpr float kDarkestShade = 0.25f;
/// Width of the step of TransferProfile::kHard, as a share of its ramp.
inline constexpr double kHardStepWidth = 0.01;

/// Maximum opacity of a structure's volume: the selection's, else its curve's, else its profile's default; at
/// most kMaxVolumeOpacity. A curve that is transparent everywhere has 0, whatever the selection's opacity.
[[nodiscard]] float full_opacity(const StructureDraw& draw);

/// The transfer function of a structure's volume over grey values. It satisfies check_curve().
///   - A ramp rises from opacity 0 and kDarkestShade at its low end to full_opacity() and shade 1 at its high
///     end. An end without a value is that of the display window. If the window's end lies on the wrong side
///     of the given end, it is one window width away from the given end.
///   - A ramp of zero or infinite width is constant at full_opacity(): one point.
///   - A curve is kept, with its extinctions scaled to the selection's opacity, if any.
/// Volumes without grey values have the optical properties of the last point.
[[nodiscard]] TransferCurve transfer_curve(const StructureDraw& draw, const Display& display);

}  // namespace splatlas
