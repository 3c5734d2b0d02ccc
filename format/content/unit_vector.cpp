// Cigolle et al. 2014, listings 1 and 2 (octahedral map) and 3 (precise rounding).
#include "format/content/unit_vector.h"

#include <algorithm>
#include <bit>
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

std::uint32_t mask(bool value) {
  return value ? ~0u : 0u;
}
float select(std::uint32_t mask, float yes, float no) {
  return std::bit_cast<float>((std::bit_cast<std::uint32_t>(yes) & mask) |
                              (std::bit_cast<std::uint32_t>(no) & ~mask));
}

/// The point of the octahedron |x| + |y| + |z| = 1 at (x, y) of its map.
std::array<float, 3> octahedron_point(float x, float y) {
  const float z = 1 - std::abs(x) - std::abs(y);
  const std::array<float, 2> outside = folded(x, y);
  const std::uint32_t is_lower = mask(z < 0);
  return {select(is_lower, outside[0], x), select(is_lower, outside[1], y), z};
}
std::array<float, 3> octahedron_point(PackedNormal packed) {
  const auto component = [](unsigned bits) {  // code -128, never written, decodes as -127
    return std::max(static_cast<float>(static_cast<std::int8_t>(bits & 0xffu)) / kScale, -1.0f);
  };
  return octahedron_point(component(packed), component(packed >> 8u));
}

bool have_directions(std::span<const std::array<float, 3>> normals) {
  return std::ranges::all_of(normals, [](const std::array<float, 3>& n) {
    const float sum = std::abs(n[0]) + std::abs(n[1]) + std::abs(n[2]);
    return sum > 0 && std::isfinite(sum);
  });
}

/// The codes of a block of vectors, all of them finite and not zero. No branches, so that compilers use
/// vectors; the operations are those of pack_normal(), in their order.
class NormalBlock {
 public:
  static constexpr std::size_t kSize = 64;
  using Lanes = std::array<float, kSize>;

  explicit NormalBlock(std::span<const std::array<float, 3>> normals) {
    load(normals);
    project();
    choose();
  }
  void pack(std::size_t count, PackedNormal* codes) const {
    for (std::size_t n = 0; n < count; ++n) codes[n] = pack_codes(best_[0][n], best_[1][n]);
  }

  /// Replaces vectors by those of their codes.
  void unpack(std::span<std::array<float, 3>> normals) const {
    std::array<Lanes, 3> unit;
    for (std::size_t n = 0; n < kSize; ++n) {
      const auto [x, y, z] = octahedron_point(best_[0][n] / kScale, best_[1][n] / kScale);
      const float length = std::sqrt(x * x + y * y + z * z);
      unit[0][n] = x / length;
      unit[1][n] = y / length;
      unit[2][n] = z / length;
    }
    for (std::size_t n = 0; n < normals.size(); ++n) normals[n] = {unit[0][n], unit[1][n], unit[2][n]};
  }

 private:
  void load(std::span<const std::array<float, 3>> normals) {
    for (std::size_t n = 0; n < kSize; ++n) {
      const std::array<float, 3>& normal = normals[n < normals.size() ? n : 0];
      for (std::size_t a = 0; a < 3; ++a) direction_[a][n] = normal[a];
    }
  }

  /// Scales the vectors, and finds the codes below their points on the octahedron.
  void project() {
    for (std::size_t n = 0; n < kSize; ++n) {
      const float x = std::abs(direction_[0][n]), y = std::abs(direction_[1][n]),
                  z = std::abs(direction_[2][n]);
      const float larger = x < y ? y : x, largest = larger < z ? z : larger;
      direction_[0][n] /= largest;
      direction_[1][n] /= largest;
      direction_[2][n] /= largest;
    }
    for (std::size_t n = 0; n < kSize; ++n) {
      const float x = direction_[0][n], y = direction_[1][n], z = direction_[2][n];
      const float sum = std::abs(x) + std::abs(y) + std::abs(z);
      const float p = x / sum, q = y / sum;
      const float folded_p = (1 - std::abs(q)) * sign_of(p), folded_q = (1 - std::abs(p)) * sign_of(q);
      low_[0][n] = low_code(z < 0 ? folded_p : p);
      low_[1][n] = low_code(z < 0 ? folded_q : q);
    }
  }
  [[nodiscard]] static float low_code(float p) {
    const float above = p < -1 ? -1.0f : p;
    const float scaled = (above > 1 ? 1.0f : above) * kScale;
    const auto truncated = static_cast<float>(static_cast<std::int32_t>(scaled));
    return truncated > scaled ? truncated - 1 : truncated;
  }

  /// Takes the best of the four codes around each point.
  void choose() {
    best_dot_.fill(-1);
    best_squared_length_.fill(1);
    for (const float dy : {0.0f, 1.0f}) {
      for (const float dx : {0.0f, 1.0f}) try_codes(dx, dy);
    }
  }
  void try_codes(float dx, float dy) {
    for (std::size_t n = 0; n < kSize; ++n) {
      const float above_x = low_[0][n] + dx, above_y = low_[1][n] + dy;
      const float code_x = std::min(above_x, kScale), code_y = std::min(above_y, kScale);
      const auto [u, v, z] = octahedron_point(code_x / kScale, code_y / kScale);
      const float dot = u * direction_[0][n] + v * direction_[1][n] + z * direction_[2][n];
      const float squared_length = u * u + v * v + z * z;
      const float best_dot = best_dot_[n], best_squared_length = best_squared_length_[n];
      const std::uint32_t better =
          mask(best_dot < 0) | mask(dot * dot * best_squared_length > best_dot * best_dot * squared_length);
      best_dot_[n] = select(better, dot, best_dot);
      best_squared_length_[n] = select(better, squared_length, best_squared_length);
      best_[0][n] = select(better, code_x, best_[0][n]);
      best_[1][n] = select(better, code_y, best_[1][n]);
    }
  }

  std::array<Lanes, 3> direction_{};
  std::array<Lanes, 2> low_{}, best_{};  // whole numbers
  Lanes best_dot_{}, best_squared_length_{};
};

}  // namespace

PackedNormal pack_normal(const std::array<float, 3>& n) {
  const float largest = std::max({std::abs(n[0]), std::abs(n[1]), std::abs(n[2])});
  const bool is_finite = std::isfinite(n[0]) && std::isfinite(n[1]) && std::isfinite(n[2]);
  if (!(largest > 0) || !is_finite) return pack_codes(0, 0);
  const std::array<float, 3> v{n[0] / largest, n[1] / largest, n[2] / largest};
  const float sum = std::abs(v[0]) + std::abs(v[1]) + std::abs(v[2]);
  std::array<float, 2> p{v[0] / sum, v[1] / sum};
  if (v[2] < 0) p = folded(p[0], p[1]);

  // Choose the nearest of the four codes around the exact point: separate rounding adds up to 0.3 degrees.
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

std::vector<PackedNormal> pack_normals(std::span<const std::array<float, 3>> normals) {
  std::vector<PackedNormal> packed(normals.size());
  for (std::size_t first = 0; first < normals.size(); first += NormalBlock::kSize) {
    const auto part = normals.subspan(first, std::min(NormalBlock::kSize, normals.size() - first));
    PackedNormal* const codes = packed.data() + first;
    if (have_directions(part)) {
      NormalBlock(part).pack(part.size(), codes);
    } else {
      std::transform(part.begin(), part.end(), codes, pack_normal);
    }
  }
  return packed;
}

void round_normals(std::span<std::array<float, 3>> normals) {
  for (std::size_t first = 0; first < normals.size(); first += NormalBlock::kSize) {
    const auto part = normals.subspan(first, std::min(NormalBlock::kSize, normals.size() - first));
    if (have_directions(part)) {
      NormalBlock(part).unpack(part);
    } else {
      for (std::array<float, 3>& normal : part) normal = unpack_normal(pack_normal(normal));
    }
  }
}

}  // namespace splatlas
