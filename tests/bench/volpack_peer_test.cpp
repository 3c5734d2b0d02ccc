#include "bench/peers/volpack_peer.h"

#include <array>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

const MaskedVolume kEmpty{{.size = {40, 50, 60}}, std::vector<std::uint8_t>(40 * 50 * 60)};

constexpr std::array<std::array<double, 2>, 7> kViews{
    {{0, 0}, {90, 0}, {30, 20}, {120, -35}, {0, 80}, {200, 10}, {-60, -70}}};

/// An off-centre box in a volume of three different sides: axes, signs, half voxels and half pixels must all
/// be right.
TEST(VolpackPeer, ShowsABoxWhereItIs) {
  MaskedVolume volume = kEmpty;
  put_box(volume, {5, 10, 12}, 3, 255);
  const GreyAppearance appearance{{{0, 0, {1, 1, 1}}, {255, 0.3, {1, 1, 1}}}};
  auto peer = VolpackPeer::classify(volume, appearance, OpacityRounding::kDown);
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
      {{0, 0, {1, 0, 0}}, {99, 3, {1, 0, 0}}, {101, 3, {1, 0, 0}}, {199, 3, {0, 1, 0}}}};
  auto peer = VolpackPeer::classify(volume, appearance, OpacityRounding::kDown);
  ASSERT_TRUE(peer);
  const auto middle_of = [&](double azimuth) {
    EXPECT_TRUE(peer->render(*parallel_view({.azimuth_deg = azimuth}, {100, 100}, kDisplay)));
    return peer->picture().at(50, 50);
  };
  EXPECT_THAT(middle_of(0), testing::Pointwise(testing::FloatNear(0.01f), {1.0f, 0.0f, 0.0f, 1.0f}));
  EXPECT_THAT(middle_of(180), testing::Pointwise(testing::FloatNear(0.01f), {0.0f, 1.0f, 0.0f, 1.0f}));
}

/// 20 voxels of opacity 1.6/255: 1/255 rounded down, 2/255 rounded to nearest.
TEST(VolpackPeer, RoundsThinOpacitiesAsTold) {
  MaskedVolume volume = kEmpty;
  put_box(volume, {10, 15, 20}, 20, 255);
  const GreyAppearance appearance{{{0, 0, {1, 1, 1}}, {255, -std::log1p(-1.6 / 255), {1, 1, 1}}}};
  const auto middle_with = [&](OpacityRounding rounding) {
    auto peer = VolpackPeer::classify(volume, appearance, rounding);
    EXPECT_TRUE(peer);
    EXPECT_TRUE(peer->render(*parallel_view(Camera{}, {100, 100}, kDisplay)));
    return peer->picture().at(50, 50)[3];
  };
  EXPECT_NEAR(middle_with(OpacityRounding::kDown), 1 - std::pow(1 - 1.0 / 255, 20), 1.0 / 255);
  EXPECT_NEAR(middle_with(OpacityRounding::kNearest), 1 - std::pow(1 - 2.0 / 255, 20), 1.0 / 255);
}

TEST(VolpackPeer, ClassifiesOnlyWhatIsVisible) {
  MaskedVolume volume = kEmpty;
  const GreyAppearance appearance{{{9, 0, {1, 1, 1}}, {10, 0.3, {1, 1, 1}}}};
  put_box(volume, {2, 2, 2}, 20, 9);  // invisible
  const auto clear = VolpackPeer::classify(volume, appearance, OpacityRounding::kDown);
  put_box(volume, {10, 15, 20}, 20, 10);
  const auto fog = VolpackPeer::classify(volume, appearance, OpacityRounding::kDown);
  ASSERT_TRUE(clear && fog);
  EXPECT_GE(fog->classified_bytes(), clear->classified_bytes() + 3 * 4 * 8000);  // 4 bytes per voxel and axis
}

TEST(VolpackPeer, RefusesWhatItCannotDrawRight) {
  const GreyAppearance appearance{{{0, 0, {1, 1, 1}}, {255, 1, {1, 1, 1}}}};
  MaskedVolume flat = kEmpty;
  flat.grid.spacing_mm = {1, 1, 2};
  const auto anisotropic = VolpackPeer::classify(flat, appearance, OpacityRounding::kDown);
  ASSERT_FALSE(anisotropic);
  EXPECT_THAT(anisotropic.error().message, testing::HasSubstr("1 x 1 x 2 mm"));
  const MaskedVolume lengthy{{.size = {2000, 1, 1}}, std::vector<std::uint8_t>(2000)};
  const auto too_long = VolpackPeer::classify(lengthy, appearance, OpacityRounding::kDown);
  ASSERT_FALSE(too_long);
  EXPECT_THAT(too_long.error().message, testing::HasSubstr("2000 x 1 x 1"));
}

}  // namespace
}  // namespace splatlas
