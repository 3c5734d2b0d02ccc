// Cigolle et al. 2014, listings 1 and 2 (octahedral map) and 3 (precise rounding).
#include "format/unit_vector.h"

#include <algorithm>
#include <cmath>

namespace splatlas {
namespace {

/// Codes -127 to 127 represent -1 to 1: symmetric, so that the six axes are exact.
constexpr float kScale = 127.0f;

float sign_of(float x) {
  return x < 0 ? -1.0f : 1.0f;
}

/// Unfolds the lower half of the octahedron around the square of the upper half, or folds it back.
std::array<float, 2> folded(float x, float y) {
  return {(1 - std::abs(y)) * sign_of(x), (1 - std::abs(x)) * sign_of(y)};
}

PackedNormal pack_codes(float x, float y) {
  const auto code = [](float v) { return static_cast<std::uint8_t>(static_cast<std::int8_t>(v)); };
  return static_cast<PackedNormal>(code(x) | code(y) << 8);
}

/// The point of a code on the octahedron |x| + |y| + |z| = 1.
std::array<float, 3> octahedron_point(PackedNormal packed) {
  const auto component = [](unsigned bits) {  // code -128, never written, decodes as -127
    return std::max(static_cast<float>(static_cast<std::int8_t>(bits & 0xffu)) / kScale, -1.0f);
  };
  std::array<float, 2> p{component(packed), component(packed >> 8u)};
  const float z = 1 - std::abs(p[0]) - std::abs(p[1]);
  if (z < 0) p = folded(p[0], p[1]);
  return {p[0], p[1], z};
}

}  // namespace

PackedNormal pack_normal(const std::array<float, 3>& n) {
  const float largest = std::max({std::abs(n[0]), std::abs(n[1]), std::abs(n[2])});
  if (!(largest > 0) || !std::isfinite(largest)) return pack_codes(0, 0);
  const std::array<float, 3> v{n[0] / largest, n[1] / largest, n[2] / largest};
  const float sum = std::abs(v[0]) + std::abs(v[1]) + std::abs(v[2]);
  std::array<float, 2> p{v[0] / sum, v[1] / sum};
  if (v[2] < 0) p = folded(p[0], p[1]);

  // Choose the nearest of the four codes around the exact point: rounding each component separately adds up
  // to 0.3 degrees.
  const float x = std::floor(std::clamp(p[0], -1.0f, 1.0f) * kScale);
  const float y = std::floor(std::clamp(p[1], -1.0f, 1.0f) * kScale);
  PackedNormal best = 0;
  float best_dot = -1, best_squared_length = 1;  // all four codes are within 90 degrees of the direction
  for (const float dy : {0.0f, 1.0f}) {
    for (const float dx : {0.0f, 1.0f}) {
      const PackedNormal code = pack_codes(std::min(x + dx, kScale), std::min(y + dy, kScale));
      const std::array<float, 3> u = octahedron_point(code);
      const float dot = u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
      const float squared_length = u[0] * u[0] + u[1] * u[1] + u[2] * u[2];
      // Compare cosines without square roots and divisions.
      if (best_dot < 0 || dot * dot * best_squared_length > best_dot * best_dot * squared_length) {
        best_dot = dot;
        best_squared_length = squared_length;
        best = code;
      }
    }
  }
  return best;
}

std::array<float, 3> unpack_normal(PackedNormal packed) {
  const auto [x, y, z] = octahedron_point(packed);
  const float length = std::sqrt(x * x + y * y + z * z);
  return {x / length, y / length, z / length};
}

}  // namespace splatlas
