// Transfer functions: what a grey value stands for in the volume of a structure.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "format/result.h"

namespace splatlas {

/// An opacity of 1 would need an infinite extinction: volumes stop here (one part in 10 000 shines through).
inline constexpr float kMaxVolumeOpacity = 0.9999f;
inline constexpr std::size_t kMaxTransferPoints = 256;

struct TransferPoint {
  double grey = 0;
  float opacity = 0;  ///< of one reference length (Atlas::reference_length_mm), 0 to kMaxVolumeOpacity
  float shade = 1;    ///< share of the structure's colour (in linear light) that shows, 0 to 1
  friend bool operator==(const TransferPoint&, const TransferPoint&) = default;
};

/// What a volume emits and absorbs at one grey value. Emission is extinction * shade * colour.
struct TransferValue {
  double extinction_per_mm = 0;
  double shade = 1;
};

/// A transfer function of grey values. Between two points the extinction (not the opacity) and the shade are
/// linear, before the first and beyond the last they are constant: one point is a constant. No points: clear.
struct TransferCurve {
  std::vector<TransferPoint> points;  ///< strictly rising grey values
  friend bool operator==(const TransferCurve&, const TransferCurve&) = default;
};

/// The extinction that absorbs `opacity` over one reference length: -ln(1 - opacity) / length.
[[nodiscard]] inline double extinction_of(float opacity, double reference_length_mm) {
  return -std::log1p(-static_cast<double>(opacity)) / reference_length_mm;
}

/// The curve at a grey value. NaN counts as lower than all. Cost: logarithmic in the points. `curve` is one
/// that check_curve() passes.
[[nodiscard]] TransferValue evaluate(const TransferCurve& curve, double grey, double reference_length_mm);

/// kUsage with the first fault, told by the point's number (from 1): no points or more than
/// kMaxTransferPoints; grey values that are not finite, do not rise, or lie too far apart for a double;
/// opacities and shades out of range.
[[nodiscard]] Result<void> check_curve(const TransferCurve& curve);

}  // namespace splatlas
