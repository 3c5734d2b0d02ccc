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

}  // namespace

VolumeLook volume_look(const StructureDraw& draw, double reference_length_mm) {
  const double opacity = std::min(draw.opacity.value_or(kDefaultVolumeOpacity), kMaxVolumeOpacity);
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
