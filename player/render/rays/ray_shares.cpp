#include "player/render/rays/ray_shares.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace splatlas {
namespace {

constexpr float kOpaque = 1e-6f;  // rounding error of a transmittance

/// Position of opacity one half in a step of constant extinction, given the opacities at its ends.
float half_of(float from, float to, float before, float behind) {
  const float share = std::log(2 * (1 - before)) / std::log((1 - before) / std::max(1 - behind, kOpaque));
  return from + share * (to - from);
}

}  // namespace

RayShares::RayShares(const RayVolume& volume) : volume_(volume) {
  trace_.owner = this;
  trace_.take = [](MarchTrace& trace) { static_cast<Trace&>(trace).owner->take(); };
  if (volume.empty()) return;
  numbers_ = volume.numbers();
  cells_ = volume.cell_numbers();
  if (volume.classification() == Classification::kBefore) extinctions_ = volume.sources()[0].optics;
  const auto& size = volume.grid().size;
  const std::size_t row = static_cast<std::size_t>(size[0]), slice = row * static_cast<std::size_t>(size[1]);
  for (std::size_t n = 0; n < 8; ++n)
    corners_[n] = (n & 1) + ((n & 2) != 0 ? row : 0) + ((n & 4) != 0 ? slice : 0);
}

void RayShares::begin(const RayPacket& rays) {
  rays_ = &rays;
  seen_.fill(0);
  depths_.fill(std::numeric_limits<float>::infinity());
  for (PixelShares& shares : shares_) shares.clear();
  trace_.count = 0;
}

void RayShares::take() {
  for (std::size_t n = 0; n < trace_.count; ++n) {
    const MarchTrace::Step& step = trace_.steps[n];
    for (std::size_t ray = 0; ray < kPacketRays; ++ray) {
      const float before = seen_[ray], behind = step.opacity[ray], rise = behind - before;
      if (!(rise > 0)) continue;
      seen_[ray] = behind;
      if (before < 0.5f && behind >= 0.5f)
        depths_[ray] = half_of(step.from[ray], step.to[ray], before, behind);
      if (cells_ != nullptr) add(ray, rise, 0.5f * (step.from[ray] + step.to[ray]));
    }
  }
  trace_.count = 0;
}

void RayShares::add_fragment(std::size_t ray, StructureIndex structure, float opacity) {
  if (opacity > seen_[ray]) shares_[ray].add(number_of(structure), opacity - seen_[ray]);
  seen_[ray] = opacity;
}

void RayShares::add(std::size_t ray, float rise, float t) {
  // Find the cell
  const auto& size = volume_.grid().size;
  std::array<std::int32_t, 3> cell{};
  std::array<float, 3> part{};
  for (std::size_t a = 0; a < 3; ++a) {
    const float at =
        std::clamp(rays_->origin[a][ray] + t * rays_->step[a][ray], 0.0f, static_cast<float>(size[a] - 2));
    cell[a] = static_cast<std::int32_t>(at);
    part[a] = at - static_cast<float>(cell[a]);
  }
  const std::size_t first = (static_cast<std::size_t>(cell[2]) * static_cast<std::size_t>(size[1]) +
                             static_cast<std::size_t>(cell[1])) *
                                static_cast<std::size_t>(size[0]) +
                            static_cast<std::size_t>(cell[0]);

  const StructureNumber one = cells_[first];
  if (one == 0) return;
  if (one != RayVolume::kSeveralNumbers) return shares_[ray].add(one, rise);

  // Divide the opacity
  const StructureNumber* const numbers = numbers_ + first;
  std::array<float, 8> weights{};
  float sum = 0;
  for (std::size_t n = 0; n < 8; ++n) {
    if (numbers[corners_[n]] == 0) continue;
    float weight = extinctions_ == nullptr ? 1 : extinctions_[4 * (first + corners_[n])];
    for (std::size_t a = 0; a < 3; ++a) weight *= (n >> a & 1) != 0 ? part[a] : 1 - part[a];
    weights[n] = weight;
    sum += weight;
  }
  if (!(sum > 0)) return;
  for (std::size_t n = 0; n < 8; ++n) {
    if (weights[n] > 0) shares_[ray].add(numbers[corners_[n]], rise * weights[n] / sum);
  }
}

}  // namespace splatlas
