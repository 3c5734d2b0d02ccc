#include "player/transfer_function.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace splatlas {
namespace {

template <typename T>
T load(const std::byte* values, std::size_t n) {
  T value;
  std::memcpy(&value, values + n * sizeof(T), sizeof(T));
  return value;
}

/// Grey values of a ramp's ends.
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
  const TransferPoint before = ramp.point(0.5 - 0.5 * kHardStepWidth, 0);
  const TransferPoint behind = ramp.point(0.5 + 0.5 * kHardStepWidth, opacity);
  // Between neighbouring numbers there is no room for a step: it is the ramp then.
  const bool has_room = low.grey < before.grey && before.grey < behind.grey && behind.grey < high.grey;
  return has_room ? TransferCurve{{low, before, behind, high}} : TransferCurve{{low, high}};
}

/// Opacity where the curve is densest.
float densest(const TransferCurve& curve) {
  float densest = 0;
  for (const TransferPoint& point : curve.points) densest = std::max(densest, point.opacity);
  return densest;
}

}  // namespace

float full_opacity(const StructureDraw& draw) {
  if (draw.opacity) return std::min(*draw.opacity, kMaxVolumeOpacity);
  if (draw.volume.curve) return densest(*draw.volume.curve);
  switch (draw.volume.profile) {
    case TransferProfile::kThin: return kDefaultThinOpacity;
    case TransferProfile::kHard: return kDefaultHardOpacity;
    case TransferProfile::kSoft: break;
  }
  return kDefaultVolumeOpacity;
}

TransferCurve transfer_curve(const StructureDraw& draw, const Display& display) {
  const float opacity = full_opacity(draw);
  if (!draw.volume.curve) return curve_of(draw.volume.profile, ramp_of(draw.volume, display), opacity);
  TransferCurve curve = *draw.volume.curve;
  const float own_opacity = densest(curve);
  if (!draw.opacity || own_opacity == 0) return curve;
  const double scale = extinction_of(opacity, 1) / extinction_of(own_opacity, 1);
  for (TransferPoint& point : curve.points) {
    point.opacity = point.opacity == own_opacity
                        ? opacity
                        : static_cast<float>(-std::expm1(-scale * extinction_of(point.opacity, 1)));
  }
  return curve;
}

VolumeLook volume_look(const StructureDraw& draw, double reference_length_mm) {
  const double opacity = full_opacity(draw);
  VolumeLook look;
  look.color = {srgb_to_linear(draw.color.r), srgb_to_linear(draw.color.g), srgb_to_linear(draw.color.b)};
  look.extinction_per_mm = static_cast<float>(-std::log1p(-opacity) / reference_length_mm);
  return look;
}

GreyRamp::GreyRamp(VoxelType type, double low, double high) : type_(type), low_(low), high_(high) {
  if (type == VoxelType::kNone || bytes_of(type) > 2) return;
  visit_voxel_type(type, [&](auto tag) {
    using T = decltype(tag);
    if constexpr (sizeof(T) <= 2) {
      using Bits = std::make_unsigned_t<T>;
      table_.resize(std::size_t{1} << (8 * sizeof(T)));
      for (std::size_t bits = 0; bits < table_.size(); ++bits) {
        table_[bits] = position_of(static_cast<double>(static_cast<T>(static_cast<Bits>(bits))));
      }
    }
  });
}

float GreyRamp::position_of(double value) const {
  if (!(low_ < high_) || !std::isfinite(high_ - low_)) return 1.0f;
  const double position = (value - low_) / (high_ - low_);
  // Written so that NaN ends at 0.
  return position > 0 ? static_cast<float>(std::min(position, 1.0)) : 0.0f;
}

void GreyRamp::positions(const std::byte* values, std::size_t first, std::size_t stride, std::size_t count,
                         float* positions) const {
  if (type_ == VoxelType::kNone) {
    std::fill_n(positions, count, 1.0f);
    return;
  }
  visit_voxel_type(type_, [&](auto tag) {
    using T = decltype(tag);
    for (std::size_t n = 0; n < count; ++n) {
      const T value = load<T>(values, first + n * stride);
      if constexpr (sizeof(T) <= 2) {
        positions[n] = table_[static_cast<std::make_unsigned_t<T>>(value)];
      } else {
        positions[n] = position_of(static_cast<double>(value));
      }
    }
  });
}

}  // namespace splatlas
