#include "player/render/sheets/slabs.h"

#include <algorithm>
#include <cmath>

namespace splatlas {
namespace {

/// Lower bound of transmittance. With a float resolution of 6e-8 it limits the error of the radiance in front
/// of a fragment to 1e-5.
constexpr float kMinTransmittance = 2e-4f;

}  // namespace

Slabs::Slabs(const Shear& shear, const Grid& grid, int parts)
    : ascending_(shear.ascending),
      last_slice_(static_cast<double>(grid.size[shear.scan.slice_axis]) - 1),
      count_(grid.size[shear.scan.slice_axis]) {
  if (parts == 1) return;
  count_ = (count_ + 1) * parts;
  begin_ = -1;
  thickness_ = 1.0 / parts;
}

Slabs::Place Slabs::at(double along) const {
  const double slabs = (along - begin_) / thickness_;
  const double slab = std::clamp(std::floor(slabs), 0.0, static_cast<double>(count_ - 1));
  return {static_cast<std::int32_t>(slab), static_cast<float>(std::clamp(slabs - slab, 0.0, 1.0))};
}

float Slabs::kept_part(std::int32_t slab, double depth, double from, double to) const {
  const double begin = begin_ + slab * thickness_;
  const double first = std::max(begin, along_of(from));
  const double last = std::min(begin + thickness_, along_of(to));
  if (!(first < last)) return 0;
  return static_cast<float>(std::clamp((along_of(depth) - first) / (last - first), 0.0, 1.0));
}

float share_of_slab(float absorbed, float part) {
  if (!(absorbed > 0) || part >= 1) return std::min(part, 1.0f);
  if (absorbed < 0.125f) {
    // Sum the binomial series, with a truncation error below 1e-7
    float share = 1 + absorbed * (5 - part) * (1.0f / 6);
    share = 1 + absorbed * (4 - part) * (1.0f / 5) * share;
    share = 1 + absorbed * (3 - part) * (1.0f / 4) * share;
    share = 1 + absorbed * (2 - part) * (1.0f / 3) * share;
    share = 1 + absorbed * (1 - part) * (1.0f / 2) * share;
    return part * share;
  }
  if (absorbed >= 1) return part > 0 ? 1.0f : 0.0f;
  return -std::expm1(part * std::log1p(-absorbed)) / absorbed;
}

float share_in_slab(float before, float behind, float part) {
  const float transmittance = 1 - before, added = behind - before;
  if (!(added > 0)) return 0;
  // Limit the opacity of the slab: rounding leaves too few digits of the transmittance behind it.
  const float max_added = transmittance - kMinTransmittance;
  return share_of_slab(std::min(added, std::max(max_added, 0.0f)) / transmittance, part);
}

}  // namespace splatlas
