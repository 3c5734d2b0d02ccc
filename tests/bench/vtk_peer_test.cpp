#include "bench/peers/vtk_peer.h"

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
using reference::PerspectiveView;

/// One display for all tests of this program.
class VtkPeerTest : public testing::TestWithParam<VtkVolumeMapper> {
 protected:
  static void SetUpTestSuite() {
    static const Result<XServer> server = start_x_server();
    ASSERT_TRUE(server);
  }
};

const Display kDisplay{.center_lps_mm = {-9, -14, 30}, .radius_mm = 40};

/// Rotated and translated, as the Colin 27 head is.
const MaskedVolume kEmpty{
    {.size = {20, 30, 40}, .origin_lps_mm = {0, 0, 10}, .direction_lps = {-1, 0, 0, 0, -1, 0, 0, 0, 1}},
    std::vector<std::uint8_t>(20 * 30 * 40)};

/// A box at a corner of the grid, whose outermost layer VTK would cut without padding.
TEST_P(VtkPeerTest, ShowsABoxWhereItIs) {
  MaskedVolume volume = kEmpty;
  put_box(volume, {0, 0, 0}, 6, 255);
  const GreyAppearance appearance{{{0, 0, {1, 0.5, 0.25}}, {255, 0.3, {1, 0.5, 0.25}}}};
  const GreyTruth truth(volume, appearance, Classification::kAfter);
  VtkPeer peer({256, 200});
  peer.add_volume(volume, appearance, GetParam(), 0.25);
  for (const auto& [azimuth, elevation] : {std::array<double, 2>{0, 0}, {30, 20}, {120, -35}, {-60, 70}}) {
    const Camera camera{.azimuth_deg = azimuth, .elevation_deg = elevation};
    const PerspectiveView view{*parallel_view(camera, {256, 200}, kDisplay), 40};
    SCOPED_TRACE(azimuth);
    peer.render(view.in_plane);
    expect_same_blob(peer.picture(), render_grey_truth(truth, volume.grid, view.in_plane, 1), 0.05, 0.04);
    peer.render(view);
    expect_same_blob(peer.picture(), render_grey_truth(truth, volume.grid, view, 1), 0.05, 0.04);
  }
}

TEST_P(VtkPeerTest, ShowsTheVolumeThatReplacesAnother) {
  MaskedVolume first = kEmpty, second = kEmpty;
  put_box(first, {2, 2, 2}, 8, 255);
  put_box(second, {10, 12, 14}, 6, 255);
  const GreyAppearance appearance{{{0, 0, {1, 1, 1}}, {255, 0.3, {1, 1, 1}}}};
  VtkPeer peer({128, 100});
  peer.add_volume(first, appearance, GetParam(), 0.25);
  const ParallelView view = *parallel_view(Camera{}, {128, 100}, kDisplay);
  peer.render(view);
  peer.replace_volume(second);
  peer.render(view);
  const GreyTruth truth(second, appearance, Classification::kAfter);
  expect_same_blob(peer.picture(), render_grey_truth(truth, second.grid, view, 1), 0.05, 0.04);
}

/// 10 mm of constant fog; premultiplied colours.
TEST_P(VtkPeerTest, ComposesAsTheClosedFormHasIt) {
  MaskedVolume volume = kEmpty;
  put_box(volume, {4, 8, 12}, 10, 200);
  const GreyAppearance appearance{{{199, 0, {0.5, 0.25, 1}}, {200, 0.1, {0.5, 0.25, 1}}}};
  VtkPeer peer({64, 64});
  peer.add_volume(volume, appearance, GetParam(), 0.1);
  const Camera camera{.center_lps_mm = index_to_lps_mm(volume.grid).apply({8.5, 12.5, 16.5})};
  peer.render(*parallel_view(camera, {64, 64}, kDisplay));
  // Grey values reach 200 at the outermost voxel centres only: 9 mm of fog, and a little of a ramp.
  const float alpha = static_cast<float>(1 - std::exp(-0.1 * 9));
  EXPECT_THAT(peer.picture().at(32, 32),
              testing::Pointwise(testing::FloatNear(0.03f), {0.5f * alpha, 0.25f * alpha, alpha, alpha}));
  EXPECT_THAT(peer.picture().at(2, 2), testing::Each(0.0f));
}

/// An opaque box, with a face 30 degrees from the view. The light is at the camera, so the GPU mapper
/// multiplies the colour by ambient + diffuse * cos(30 degrees) = 0.15 + 0.85 * 0.866 = 0.886. FixedPoint
/// interpolates the shades of voxels. Those inside the box have no gradient, so it is darker.
TEST_P(VtkPeerTest, LightsByGradientsIfTold) {
  MaskedVolume volume = kEmpty;
  put_box(volume, {4, 8, 12}, 16, 200);
  const GreyAppearance appearance{{{100, 0, {1, 1, 1}}, {101, 5, {1, 1, 1}}}};
  VtkPeer peer({64, 64});
  peer.add_volume(volume, appearance, GetParam(), 0.1);
  Camera camera = Camera::of(NamedView::kAnterior);
  camera.azimuth_deg += 30;
  camera.zoom = 2;
  camera.center_lps_mm = index_to_lps_mm(volume.grid).apply({11.5, 15.5, 19.5});
  const auto red = [&] {
    peer.render(*parallel_view(camera, {64, 64}, kDisplay));
    return peer.picture().at(32, 32)[0];
  };
  EXPECT_NEAR(red(), 1, 0.02);
  peer.shade_volumes(true);
  const float lit = red();
  EXPECT_LT(lit, 0.886 + 0.04);
  EXPECT_GT(lit, GetParam() == VtkVolumeMapper::kGpu ? 0.886 - 0.04 : 0.6);
  peer.shade_volumes(false);
  EXPECT_NEAR(red(), 1, 0.02);
}

INSTANTIATE_TEST_SUITE_P(Mappers, VtkPeerTest,
                         testing::Values(VtkVolumeMapper::kFixedPoint, VtkVolumeMapper::kGpu),
                         [](const auto& which) {
                           return which.param == VtkVolumeMapper::kGpu ? "Gpu" : "FixedPoint";
                         });

/// Two translucent squares with fog between them, added in the wrong order.
TEST_F(VtkPeerTest, PeelsSurfacesAndVolumeInOrder) {
  MaskedVolume volume = kEmpty;
  put_box(volume, {0, 10, 0}, 9, 255);
  const GreyAppearance appearance{{{254, 0, {0, 0, 1}}, {255, 0.2, {0, 0, 1}}}};
  const auto square_at = [](float j) {
    SurfaceMesh mesh;
    mesh.positions_ijk = {{0, j, 0}, {9, j, 0}, {9, j, 9}, {0, j, 9}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
  };
  VtkPeer peer({64, 64});
  peer.add_surface(square_at(2), volume.grid, {1, 0, 0}, 0.5);  // posterior: j grows to anterior
  peer.add_surface(square_at(27), volume.grid, {0, 1, 0}, 0.5);
  peer.add_volume(volume, appearance, VtkVolumeMapper::kGpu, 0.1);
  peer.peel_depths();
  Camera camera{.zoom = 3, .center_lps_mm = index_to_lps_mm(volume.grid).apply({4, 14, 4})};
  const auto fog = static_cast<float>(1 - std::exp(-0.2 * 8));
  peer.render(*parallel_view(camera, {64, 64}, kDisplay));
  EXPECT_THAT(peer.picture().at(32, 32),
              testing::Pointwise(testing::FloatNear(0.02f),
                                 {0.25f * (1 - fog), 0.5f, 0.5f * fog, 1 - 0.25f * (1 - fog)}));
  camera.azimuth_deg = 180;
  peer.render(*parallel_view(camera, {64, 64}, kDisplay));
  EXPECT_THAT(peer.picture().at(32, 32),
              testing::Pointwise(testing::FloatNear(0.02f),
                                 {0.5f, 0.25f * (1 - fog), 0.5f * fog, 1 - 0.25f * (1 - fog)}));
}

}  // namespace
}  // namespace splatlas
