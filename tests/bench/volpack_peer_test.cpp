#include "bench/peers/volpack_peer.h"

#include <array>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "format/content/unit_vector.h"
#include "tests/bench/peer_pictures.h"
#include "tests/reference/grey_truth.h"

namespace splatlas {
namespace {

using reference::Classification;
using reference::GreyAppearance;
using reference::GreyTruth;
using reference::MaskedVolume;
using reference::ReferencePicture;

const Display kDisplay{.center_lps_mm = {19.5, 24.5, 29.5}, .radius_mm = 45};

/// Without light.
MaskedVolume empty_volume() {
  MaskedVolume volume{{.size = {40, 50, 60}}, std::vector<std::uint8_t>(40 * 50 * 60)};
  volume.normals.assign(volume.greys.size(), MaskedVolume::kUnlit);
  return volume;
}
const MaskedVolume kEmpty = empty_volume();

constexpr std::array<std::array<double, 2>, 7> kViews{
    {{0, 0}, {90, 0}, {30, 20}, {120, -35}, {0, 80}, {200, 10}, {-60, -70}}};

/// An off-centre box in a volume of three different sides: axes, signs, half voxels must be right.
TEST(VolpackPeer, ShowsABoxWhereItIs) {
  MaskedVolume volume = kEmpty;
  put_box(volume, {5, 10, 12}, 3, 255);
  const GreyAppearance appearance{{{0, 0, {1, 1, 1}}, {255, 0.3, {1, 1, 1}}}};
  auto peer = VolpackPeer::classify(volume, appearance);
  ASSERT_TRUE(peer);
  const GreyTruth truth(volume, appearance, Classification::kBefore);
  for (const auto& [azimuth, elevation] : kViews) {
    for (const double zoom : {1.0, 2.5}) {
      const Camera camera{azimuth, elevation, zoom, Vec3{12, 16, 20}};
      const ParallelView view = *parallel_view(camera, {256, 200}, kDisplay);
      const ReferencePicture expected = render_grey_truth(truth, volume.grid, view, 1);
      ASSERT_TRUE(peer->render(view));
      SCOPED_TRACE(testing::Message() << azimuth << " " << elevation << " " << zoom);
      // The centroid is tighter than the effect of any wrong half: a pixel is 0.47 mm or 0.19 mm wide here.
      // VolPack interpolates opacities, not extinctions, of rows of 3 voxels.
      expect_same_blob(peer->picture(), expected, 0.08, 0.12);
    }
  }
}

/// Two opaque boxes, one behind the other: the nearer one hides the other.
TEST(VolpackPeer, HidesWhatIsBehind) {
  MaskedVolume volume = kEmpty;
  put_box(volume, {14, 8, 24}, 12, 100);   // anterior
  put_box(volume, {14, 30, 24}, 12, 200);  // posterior
  const GreyAppearance appearance{
      {{0, 0, {1, 0.5, 0}}, {99, 3, {1, 0.5, 0}}, {101, 3, {1, 0.5, 0}}, {199, 3, {0.5, 0.25, 0}}}};
  auto peer = VolpackPeer::classify(volume, appearance);
  ASSERT_TRUE(peer);
  const auto middle_of = [&](double azimuth) {
    EXPECT_TRUE(peer->render(*parallel_view({.azimuth_deg = azimuth}, {100, 100}, kDisplay)));
    return peer->picture().at(50, 50);
  };
  EXPECT_THAT(middle_of(0), testing::Pointwise(testing::FloatNear(0.01f), {1.0f, 0.5f, 0.0f, 1.0f}));
  EXPECT_THAT(middle_of(180), testing::Pointwise(testing::FloatNear(0.01f), {0.5f, 0.25f, 0.0f, 1.0f}));
}

/// 20 voxels of opacity 1.6/255: 1/255 rounded down.
TEST(VolpackPeer, RoundsThinOpacitiesDown) {
  MaskedVolume volume = kEmpty;
  put_box(volume, {10, 15, 20}, 20, 255);
  const GreyAppearance appearance{{{0, 0, {1, 1, 1}}, {255, -std::log1p(-1.6 / 255), {1, 1, 1}}}};
  auto peer = VolpackPeer::classify(volume, appearance);
  ASSERT_TRUE(peer);
  ASSERT_TRUE(peer->render(*parallel_view(Camera{}, {100, 100}, kDisplay)));
  EXPECT_NEAR(peer->picture().at(50, 50)[3], 1 - std::pow(1 - 1.0 / 255, 20), 1.0 / 255);
}

/// Red light of the quarters of a picture.
template <typename RedAt>
std::array<double, 4> red_of_quarters(const PictureSize& size, const RedAt& red_at) {
  std::array<double, 4> red{};
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x)
      red[static_cast<std::size_t>((x < size.width / 2 ? 0 : 1) + (y < size.height / 2 ? 0 : 2))] +=
          red_at(x, y);
  }
  return red;
}
std::array<double, 4> red_of_quarters(const Picture& picture) {
  return red_of_quarters(picture.size,
                         [&](int x, int y) { return static_cast<double>(picture.at(x, y)[0]); });
}
std::array<double, 4> red_of_quarters(const ReferencePicture& picture) {
  return red_of_quarters(picture.size, [&](int x, int y) {
    return picture.pixels[static_cast<std::size_t>(y * picture.size.width + x)][0];
  });
}

/// Fog in two grey values with the normals of a ball in its outer layers, and none inside.
MaskedVolume ball_with_normals() {
  MaskedVolume volume = kEmpty;
  volume.normals.assign(volume.greys.size(), MaskedVolume::kOutside);
  for (std::int64_t k = 0; k < 60; ++k) {
    for (std::int64_t j = 0; j < 50; ++j) {
      for (std::int64_t i = 0; i < 40; ++i) {
        const std::array<float, 3> normal{static_cast<float>(i - 19), static_cast<float>(j - 24),
                                          static_cast<float>(k - 29)};
        const float radius = std::hypot(normal[0], normal[1], normal[2]);
        if (radius > 15) continue;
        const auto voxel = static_cast<std::size_t>(volume.grid.offset(i, j, k));
        volume.greys[voxel] = i < 19 ? 100 : 200;
        volume.normals[voxel] = radius > 12 ? std::int32_t{pack_normal(normal)} : MaskedVolume::kUnlit;
      }
    }
  }
  return volume;
}

/// The share of light that shading leaves in each quarter of the picture is that of the model. The ratio of
/// two pictures is free of VolPack's errors of opacity. Its codes of normals are up to 2 degrees off.
TEST(VolpackPeer, LightsBoundaryVoxelsAsTheModelDoes) {
  const MaskedVolume volume = ball_with_normals();
  const GreyAppearance appearance{{{0, 0, {0.25, 0.125, 0}}, {255, 0.5, {1, 0.5, 0}}}};
  MaskedVolume without_normals = volume;
  without_normals.normals.assign(volume.normals.size(), MaskedVolume::kUnlit);
  auto lit = VolpackPeer::classify(volume, appearance);
  auto unlit = VolpackPeer::classify(without_normals, appearance);
  ASSERT_TRUE(lit && unlit);
  for (const auto& [azimuth, elevation] : kViews) {
    SCOPED_TRACE(testing::Message() << azimuth << " " << elevation);
    const ParallelView view = *parallel_view({azimuth, elevation}, {128, 128}, kDisplay);
    ASSERT_TRUE(lit->render(view) && unlit->render(view));
    const GreyTruth lit_truth(volume, appearance, Classification::kBefore, &view);
    const GreyTruth unlit_truth(volume, appearance, Classification::kBefore);
    const auto with = red_of_quarters(lit->picture()), without = red_of_quarters(unlit->picture());
    const auto expected_with = red_of_quarters(render_grey_truth(lit_truth, volume.grid, view, 1));
    const auto expected_without = red_of_quarters(render_grey_truth(unlit_truth, volume.grid, view, 1));
    for (std::size_t n = 0; n < 4; ++n) {
      EXPECT_LT(expected_with[n], 0.97 * expected_without[n]);
      EXPECT_NEAR(with[n] / without[n], expected_with[n] / expected_without[n], 0.015) << n;
    }
  }
}

}  // namespace
}  // namespace splatlas
