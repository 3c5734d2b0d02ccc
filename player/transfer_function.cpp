#include "player/transfer_function.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace splatlas {
namespace {

/// Grey values at the ends of a ramp.
struct Ramp {
  double low = 0, high = 0;

  [[nodiscard]] bool has_width() const { return low < high && std::isfinite(high - low); }
  [[nodiscard]] TransferPoint point(double position, float opacity) const {
    return {low + position * (high - low), opacity,
            static_cast<float>(kDarkestShade + (1.0 - kDarkestShade) * position)};
  }
};

Ramp ramp_of(const VolumeStyle& style, const Display& display) {
  Ramp ramp{style.low.value_or(display.window_low), style.high.value_or(display.window_high)};
  if (ramp.low < ramp.high || style.low.has_value() == style.high.has_value()) return ramp;
  const double width = std::max(display.window_high - display.window_low, 0.0);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (style.low) {
    ramp.high = std::max(ramp.low + width, std::nextafter(ramp.low, kInfinity));
  } else {
    ramp.low = std::min(ramp.high - width, std::nextafter(ramp.high, -kInfinity));
  }
  return ramp;
}

TransferCurve curve_of(TransferProfile profile, const Ramp& ramp, float opacity) {
  if (!ramp.has_width()) return {{{0, opacity, 1}}};
  const TransferPoint low = ramp.point(0, 0);
  const TransferPoint high{ramp.high, opacity, 1};
  if (profile != TransferProfile::kHard) return {{low, high}};
  const TransferPoint before{ramp.point(0.5 - 0.5 * kHardStepWidth, 0).grey, 0, 1};
  const TransferPoint behind{ramp.point(0.5 + 0.5 * kHardStepWidth, 0).grey, opacity, 1};
  // Keep the ramp where neighbouring doubles leave no room for a step.
  const bool has_room = low.grey < before.grey && before.grey < behind.grey && behind.grey < high.grey;
  return has_room ? TransferCurve{{low, before, behind, high}} : TransferCurve{{low, high}};
}

float max_opacity(const TransferCurve& curve) {
  float opacity = 0;
  for (const TransferPoint& point : curve.points) opacity = std::max(opacity, point.opacity);
  return opacity;
}

/// Default opacity of a structure's volume.
float opacity_of(const VolumeStyle& style) {
  if (style.curve) return max_opacity(*style.curve);
  switch (style.profile) {
    case TransferProfile::kThin: return kDefaultThinOpacity;
    case TransferProfile::kHard: return kDefaultHardOpacity;
    case TransferProfile::kSoft: break;
  }
  return kDefaultVolumeOpacity;
}

}  // namespace

float full_opacity(const StructureDraw& draw) {
  const float own = opacity_of(draw.volume);
  return draw.opacity && own > 0 ? std::min(*draw.opacity, kMaxVolumeOpacity) : own;
}

TransferCurve transfer_curve(const StructureDraw& draw, const Display& display) {
  const float opacity = full_opacity(draw);
  if (!draw.volume.curve) return curve_of(draw.volume.profile, ramp_of(draw.volume, display), opacity);
  TransferCurve curve = *draw.volume.curve;
  const float own_opacity = max_opacity(curve);
  if (!draw.opacity || own_opacity == 0) return curve;
  const double scale = extinction_of(opacity, 1) / extinction_of(own_opacity, 1);
  for (TransferPoint& point : curve.points) {
    point.opacity = point.opacity == own_opacity
                        ? opacity
                        : static_cast<float>(-std::expm1(-scale * extinction_of(point.opacity, 1)));
  }
  return curve;
}

}  // namespace splatlas
