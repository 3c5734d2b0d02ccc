#include "player/render/transfer/shading.h"

#include <limits>
#include <random>
#include <utility>

#include <gtest/gtest.h>

#include "format/content/unit_vector.h"
#include "tests/reference/reference_radiance.h"

namespace splatlas {
namespace {

ParallelView view_from(double azimuth_deg, double elevation_deg) {
  const Camera camera{.azimuth_deg = azimuth_deg, .elevation_deg = elevation_deg};
  return *parallel_view(camera, {8, 8}, Display{});
}

TEST(Shading, EqualsTheReferenceForAnyNormalAndView) {
  std::mt19937 random(1);
  std::normal_distribution<float> gauss;
  for (int view_number = 0; view_number < 20; ++view_number) {
    const ParallelView view = view_from(gauss(random) * 100, gauss(random) * 40);
    const Lighting lighting(view);
    const std::vector<float> table = lighting.table();
    for (int n = 0; n < 500; ++n) {
      const float length = std::exp(3 * gauss(random));
      const std::array<float, 3> normal{length * gauss(random), length * gauss(random),
                                        length * gauss(random)};
      const Vec3 exact{normal[0], normal[1], normal[2]};
      const PackedNormal code = pack_normal(normal);
      const auto [x, y, z] = unpack_normal(code);
      EXPECT_NEAR(table[code], reference::diffuse(view, {x, y, z}), 1e-6);
      const std::array<float, 3> color{0.2f, 0.7f, 1.0f};
      const SurfaceShading shading = lighting.on_surface(normal);
      const auto expected = reference::shade_surface(view, {0.2f, 0.7f, 1.0f}, exact);
      for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(shading.on(color[c]), expected[c], 2e-6);
    }
  }
}

/// Neighbouring codes are 1.3 degrees apart at most; the factor changes by 0.85 per radian at most.
TEST(Shading, ChangesLittleFromOneCodeToTheNext) {
  for (const auto& [azimuth, elevation] : {std::pair(0, 0), {33, -12}, {-70, 55}}) {
    const Lighting lighting(view_from(azimuth, elevation));
    const std::vector<float> table = lighting.table();
    for (int y = -127; y < 127; ++y) {
      for (int x = -127; x < 127; ++x) {
        const auto code = [](int u, int v) {
          return static_cast<PackedNormal>((u & 0xff) | (v & 0xff) << 8);
        };
        const float here = table[code(x, y)];
        for (const PackedNormal next : {code(x + 1, y), code(x, y + 1)}) {
          const auto a = unpack_normal(code(x, y)), b = unpack_normal(next);
          const double chord = std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
          ASSERT_LE(std::abs(table[next] - here), 0.85 * 1.001 * chord + 1e-6) << x << ", " << y;
        }
      }
    }
  }
}

TEST(Shading, LeavesNormalsOfSurfacesAsTheyAre) {
  const ParallelView view = view_from(33, -12);
  const Lighting lighting(view);
  std::array<float, 3> from_light{};
  for (std::size_t a = 0; a < 3; ++a) {
    from_light[a] =
        static_cast<float>(view.forward_lps[a] + 0.45 * view.right_lps[a] - 0.55 * view.up_lps[a]);
  }
  EXPECT_FLOAT_EQ(lighting.on_surface(from_light).on(1), 0.15f);
  // Mirrored: -l . l + 2 (l . v)^2, with 1 / (l . v)^2 = 1 + 0.45^2 + 0.55^2
  const Vec3 exact{from_light[0], from_light[1], from_light[2]};
  EXPECT_NEAR(reference::diffuse(view, exact), 0.15 + 0.85 * (2 / 1.505 - 1), 1e-6);
}

TEST(Shading, DiffuseStaysBetweenAmbientAndOne) {
  const ParallelView view = view_from(-70, 55);
  const Lighting lighting(view);
  const std::vector<float> table = lighting.table();
  ASSERT_EQ(table.size(), 65536u);
  float min = 1;
  float max = 0;
  for (std::size_t n = 0; n < table.size(); ++n) {
    const std::array<float, 3> normal = unpack_normal(static_cast<PackedNormal>(n));
    EXPECT_NEAR(table[n], reference::diffuse(view, {normal[0], normal[1], normal[2]}), 1e-6);
    min = std::min(min, table[n]);
    max = std::max(max, table[n]);
    EXPECT_LE(lighting.on_surface(normal).on(1), 1.0f);
  }
  EXPECT_FLOAT_EQ(min, 0.15f);
  EXPECT_GT(max, 0.999f);
  EXPECT_LE(max, 1.0f);
}

TEST(Shading, LightsNormalsThatAreNoneAsIfTheyFacedTheViewer) {
  const ParallelView view = view_from(10, 20);
  const Lighting lighting(view);
  const std::array<float, 3> facing{static_cast<float>(-view.forward_lps[0]),
                                    static_cast<float>(-view.forward_lps[1]),
                                    static_cast<float>(-view.forward_lps[2])};
  const float nan = std::numeric_limits<float>::quiet_NaN(), expected = lighting.on_surface(facing).diffuse;
  EXPECT_NEAR(lighting.on_surface({0, 0, 0}).diffuse, expected, 1e-6f);
  EXPECT_NEAR(lighting.on_surface({nan, 0, 0}).diffuse, expected, 1e-6f);
}

}  // namespace
}  // namespace splatlas
