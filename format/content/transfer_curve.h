// Piecewise linear transfer functions: optical properties of a structure's grey values.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "format/result.h"

namespace splatlas {

/// Maximum opacity of a volume per reference length: opacity 1 would need infinite extinction.
inline constexpr float kMaxVolumeOpacity = 0.9999f;
inline constexpr std::size_t kMaxTransferPoints = 256;

/// Control point of a transfer function.
struct TransferPoint {
  double grey = 0;
  float opacity = 0;  ///< per reference length (Atlas::reference_length_mm), 0 to kMaxVolumeOpacity
  float shade = 1;    ///< factor on the structure's colour in linear RGB, 0 to 1
  friend bool operator==(const TransferPoint&, const TransferPoint&) = default;
};

/// Optical properties at one grey value. Emission is extinction * shade * colour.
struct TransferValue {
  double extinction_per_mm = 0;
  double shade = 1;
};

/// A transfer function of grey values. Extinction (not opacity) and shade are linear between points, and
/// constant before the first and after the last. Without points the volume is transparent.
struct TransferCurve {
  std::vector<TransferPoint> points;  ///< strictly increasing grey values
  friend bool operator==(const TransferCurve&, const TransferCurve&) = default;
};

/// Extinction (1/mm) with the given opacity over one reference length: -ln(1 - opacity) / length.
[[nodiscard]] inline double extinction_of(float opacity, double reference_length_mm) {
  return -std::log1p(-static_cast<double>(opacity)) / reference_length_mm;
}

/// Evaluates the curve at a grey value. NaN sorts below all values. `curve` must pass check_curve() or be
/// empty. Cost: logarithmic in the number of points.
[[nodiscard]] TransferValue evaluate(const TransferCurve& curve, double grey, double reference_length_mm);

/// kUsage with the first fault and the number of its point (from 1). Requires 1 to kMaxTransferPoints points
/// and strictly increasing grey values with finite differences. Opacities and shades must be in range.
[[nodiscard]] Result<void> check_curve(const TransferCurve& curve);

}  // namespace splatlas
