#include "player/transfer/shading.h"

#include "format/unit_vector.h"

namespace splatlas {
namespace {

std::array<float, 3> normalised(const Vec3& v) {
  const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  return {static_cast<float>(v[0] / length), static_cast<float>(v[1] / length),
          static_cast<float>(v[2] / length)};
}

}  // namespace

Lighting::Lighting(const ParallelView& view) {
  Vec3 viewer{};
  Vec3 light{};
  Vec3 half{};
  for (std::size_t a = 0; a < 3; ++a) {
    viewer[a] = -view.forward_lps[a];
    light[a] = viewer[a] - 0.45 * view.right_lps[a] + 0.55 * view.up_lps[a];
  }
  to_viewer_ = normalised(viewer);
  to_light_ = normalised(light);
  for (std::size_t a = 0; a < 3; ++a) half[a] = to_viewer_[a] + to_light_[a];
  half_ = normalised(half);
}

float Lighting::one_sided(const std::array<float, 3>& normal_lps) const {
  const float length_squared = dot(normal_lps, normal_lps);
  float facing = dot(to_viewer_, to_light_);
  if (length_squared > 0) facing = std::max(0.0f, dot(normal_lps, to_light_) / std::sqrt(length_squared));
  return kAmbient + (1.0f - kAmbient) * std::min(facing, 1.0f);
}

float Lighting::diffuse(const std::array<float, 3>& normal_lps) const {
  if (!(dot(normal_lps, to_viewer_) < 0)) return one_sided(normal_lps);
  return one_sided({-normal_lps[0], -normal_lps[1], -normal_lps[2]});
}

std::vector<float> Lighting::table() const {
  std::vector<float> factors(65536);
  for (std::size_t n = 0; n < factors.size(); ++n)
    factors[n] = diffuse(unpack_normal(static_cast<PackedNormal>(n)));
  return factors;
}

}  // namespace splatlas
