// Pictures with values known in closed form.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "player/render/view/shear.h"
#include "tests/reference/picture_difference.h"
#include "tests/support/phantom_content.h"
#include "tests/support/render.h"
#include "tests/support/repetitions.h"
#include "tests/support/uniform_box.h"

namespace splatlas {
namespace {

RenderOptions unlit(const PictureSize& size, Classification classification = Classification::kBefore) {
  return {.size = size, .classification = classification, .hybrid_shading = false};
}

/// In frames of sheets and of rays.
TEST(ClosedForm, ThousandsOfThinLayersAddUp) {
  for (const auto& [layers, classification] : {std::pair(1000, Classification::kBefore),
                                               {4000, Classification::kBefore},
                                               {4000, Classification::kAfter}}) {
    const bool sheets = classification == Classification::kBefore;
    const AtlasContent content = box_content({5, 5, layers});
    Camera camera = Camera::of(NamedView::kSuperior);
    camera.zoom = layers / 5.0;
    constexpr std::array kOpacities{1e-8f, 1e-7f, 1e-6f, 1e-5f, 1e-4f, 1e-3f, 1e-2f};
    for (std::size_t n = 0; n < kOpacities.size(); n += kEveryNth) {
      const float opacity = kOpacities[n];
      SCOPED_TRACE(testing::Message() << layers << " layers of " << opacity << (sheets ? "" : ", by rays"));
      Renderer renderer = renderer_of(content, with_opacity(content, opacity));
      for (const bool simd : {false, true}) {
        const Picture picture =
            render_or_throw(renderer, camera, unlit({9, 9}, classification), {.simd = simd});
        const double expected = opacity_through(layers, opacity);
        // Every addition rounds by at most half a unit in the last place, usually to either side. Opaque
        // pixels end at the threshold of early ray termination.
        const double rounding = sheets ? std::min(1e-6, layers * 6e-8 * expected) : layers * 6e-8 * expected;
        EXPECT_NEAR(picture.at(4, 4)[3], expected, std::max(rounding, expected > 0.999 ? 1e-4 : 0));
        EXPECT_LE(reference::energy_violation(picture), sheets ? 2e-7 : 1e-5);
      }
    }
  }
}

/// The larger ball of the phantom has 21 voxels on each axis through its centre.
TEST(ClosedForm, OpacityOfThePhantomsBallAlongItsAxes) {
  TestVolume volume;
  volume.grid.size = {phantom::kSize, phantom::kSize, phantom::kSize};
  volume.structures = {{"ball", phantom_mask(phantom::kBalls[0])}};
  const AtlasContent content = make_content(volume);
  ASSERT_EQ(content.display.center_lps_mm, (Vec3{11, 11, 11}));
  for (const float opacity : {0.01f, 0.1f, 0.3f}) {
    for (int view = 0; view < 6; ++view) {
      const Picture picture = render_or_throw(content, with_opacity(content, opacity),
                                              Camera::of(static_cast<NamedView>(view)), {.size = {65, 65}});
      EXPECT_NEAR(picture.at(32, 32)[3], opacity_through(21, opacity), 1e-6) << "view " << view;
    }
  }
}

/// A ball of radius R mm whose voxels hold their coverage, to first order.
TEST(ClosedForm, OpacityOfABallInAnyDirection) {
  constexpr double kRadius = 20.3;
  constexpr std::int64_t kSide = 47;
  std::vector<float> covered;
  TestVolume volume;
  volume.grid.size = {kSide, kSide, kSide};
  volume.structures = {{"ball", make_mask(volume.grid.size, [&](auto i, auto j, auto k) {
                          const auto x = static_cast<double>(i - kSide / 2);
                          const auto y = static_cast<double>(j - kSide / 2);
                          const auto z = static_cast<double>(k - kSide / 2);
                          const double distance = std::sqrt(x * x + y * y + z * z);
                          covered.push_back(
                              static_cast<float>(std::clamp(kRadius - distance + 0.5, 0.0, 1.0)));
                          return covered.back() > 0;
                        })}};
  volume.values = make_values(VoxelType::kFloat32, covered);
  const AtlasContent content = make_content(volume);
  const float opacity = 0.03f;
  Renderer renderer = renderer_of(content, with_opacity(content, opacity));
  for (const auto& [azimuth, elevation] :
       {std::pair(0.0, 0.0), {90, 0}, {0, 90}, {30, 20}, {45, 0}, {45, 35}, {200, -50}, {-73, 12}}) {
    const Camera camera{
        .azimuth_deg = azimuth, .elevation_deg = elevation, .zoom = zoom_for(content.display, 51, 1.0)};
    const Picture picture = render_or_throw(renderer, camera, {.size = {51, 51}, .quality = Quality::kHigh});
    if (std::fmod(azimuth, 90) == 0 && std::fmod(elevation, 90) == 0) {
      EXPECT_NEAR(picture.at(25, 25)[3], opacity_through(2 * kRadius, opacity), 1e-3);
    }
    // Slices sample a rise no wider than their distance along the ray: each end of a chord errs by at most
    // 1/8 of it. Towards the rim, chords change faster than voxels resolve.
    const ParallelView view = *parallel_view(camera, {51, 51}, content.display);
    const double bound_mm = factorise(view, storage_grid(content)).slab_mm / 4;
    for (int y = 0; y < 51; ++y) {
      for (int x = 0; x < 51; ++x) {
        const double from_axis = std::hypot(x - 25.0, y - 25.0);
        if (from_axis > kRadius / 2) continue;
        const double chord = 2 * std::sqrt(kRadius * kRadius - from_axis * from_axis);
        EXPECT_GE(picture.at(x, y)[3], opacity_through(chord - bound_mm, opacity))
            << "azimuth " << azimuth << ", elevation " << elevation << ", pixel " << x << ", " << y;
        EXPECT_LE(picture.at(x, y)[3], opacity_through(chord + bound_mm, opacity))
            << "azimuth " << azimuth << ", elevation " << elevation << ", pixel " << x << ", " << y;
      }
    }
  }
}

/// A plate of 7 voxels has the same opacity in every pixel, from directions whose rays cross its large faces.
void expect_flat_plate(const RenderOptions& options, double mm_per_pixel, double tolerance) {
  const AtlasContent content = box_content({64, 7, 64});
  const float opacity = 0.12f;
  Renderer renderer = renderer_of(content, with_opacity(content, opacity));
  for (const auto& [azimuth, elevation] :
       {std::pair(0.0, 0.0), {1e-6, 0.0}, {17.3, 0.0}, {-31.0, 20.0}, {44.99, 0.0}, {0.0, -40.0}}) {
    const Camera camera{.azimuth_deg = azimuth,
                        .elevation_deg = elevation,
                        .zoom = zoom_for(content.display, options.size.width, mm_per_pixel),
                        .center_lps_mm = Vec3{31.77, 3.0, 31.41}};
    const Picture picture = render_or_throw(renderer, camera, options);
    const double length =
        7 / (std::cos(azimuth * std::numbers::pi / 180) * std::cos(elevation * std::numbers::pi / 180));
    for (int n = 0; n < options.size.width * options.size.height; ++n) {
      const auto pixel = picture.at(n % options.size.width, n / options.size.width);
      EXPECT_NEAR(pixel[3], opacity_through(length, opacity), tolerance)
          << "azimuth " << azimuth << ", elevation " << elevation << ", " << mm_per_pixel << " mm a pixel";
      EXPECT_NEAR(pixel[0], pixel[3], tolerance);
    }
  }
}

/// Slabs are exact between faces parallel to the slices: the plate is flat for every angle, zoom, pixel.
TEST(ClosedForm, PlatesAreFlatAtAnyAngle) {
  for (const double mm_per_pixel : {0.11, 0.5, 1.0, 1.37}) {
    for (const Quality quality : {Quality::kDraft, Quality::kNormal, Quality::kHigh}) {
      RenderOptions options = unlit({15, 15});
      options.quality = quality;
      // Slab length, seven products and sums, and weights that add up to 1, all in float.
      expect_flat_plate(options, mm_per_pixel, 1e-6);
    }
  }
}

TEST(ClosedForm, PlatesAreFlatAlongRays) {
  expect_flat_plate(unlit({15, 15}, Classification::kAfter), 0.5, 4e-6);
}

}  // namespace
}  // namespace splatlas
