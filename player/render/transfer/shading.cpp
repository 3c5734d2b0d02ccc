#include "player/render/transfer/shading.h"

#include "format/content/unit_vector.h"

namespace splatlas {
namespace {

std::array<float, 3> normalised(const Vec3& v) {
  const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  return {static_cast<float>(v[0] / length), static_cast<float>(v[1] / length),
          static_cast<float>(v[2] / length)};
}

constexpr std::size_t kPackedNormals = 65536;

}  // namespace

UnpackedNormals::UnpackedNormals() : x(kPackedNormals), y(kPackedNormals), z(kPackedNormals) {
  for (std::size_t n = 0; n < kPackedNormals; ++n) {
    const std::array<float, 3> normal = unpack_normal(static_cast<PackedNormal>(n));
    x[n] = normal[0];
    y[n] = normal[1];
    z[n] = normal[2];
  }
}

const UnpackedNormals& unpacked_normals() {
  static const UnpackedNormals kNormals;
  return kNormals;
}

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

void Lighting::on_surfaces(std::size_t count, const std::array<const float*, 3>& normals_lps, float* diffuse,
                           float* highlight) const {
  const Lighting lighting = *this;  // a copy: the results cannot alias it
  for (std::size_t n = 0; n < count; ++n) {
    const SurfaceShading shading =
        lighting.on_surface({normals_lps[0][n], normals_lps[1][n], normals_lps[2][n]});
    diffuse[n] = shading.diffuse;
    highlight[n] = shading.highlight;
  }
}

std::vector<float> Lighting::table() const {
  const UnpackedNormals& normals = unpacked_normals();
  std::vector<float> factors(kPackedNormals);
  // The mirrored normal m = n - 2 min(0, n . v) v has m . l = n . l - 2 min(0, n . v) (v . l)
  const float twice_viewer_to_light = 2 * dot(to_viewer_, to_light_);
  for (std::size_t n = 0; n < kPackedNormals; ++n) {
    const auto along = [&](const std::array<float, 3>& direction) {
      return normals.x[n] * direction[0] + normals.y[n] * direction[1] + normals.z[n] * direction[2];
    };
    const float facing = along(to_light_) - std::min(0.0f, along(to_viewer_)) * twice_viewer_to_light;
    factors[n] = kAmbient + (1.0f - kAmbient) * std::clamp(facing, 0.0f, 1.0f);
  }
  return factors;
}

}  // namespace splatlas
