// Pictures of transfer functions with values known in closed form.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/support/render.h"

namespace splatlas {
namespace {

/// A layer of voxels, 1 mm thick.
struct Layer {
  double grey = 0;
  double halvings = 0;  ///< transmittance of the layer, in halvings
  double shade = 1;
};

/// A white box from above, with one grey value per layer, top layer first.
template <typename T>
AtlasContent layered_box(const std::vector<Layer>& layers) {
  TestVolume volume;
  volume.grid.size = {5, 5, static_cast<std::int64_t>(layers.size())};
  volume.structures = {{"box", full_mask(volume.grid.size)}};
  std::vector<T> values;
  for (auto layer = layers.rbegin(); layer != layers.rend(); ++layer) {
    values.insert(values.end(), 25, static_cast<T>(layer->grey));
  }
  volume.values = make_values(voxel_type_of<T>(), values);
  volume.window_low = 0;
  volume.window_high = 100;
  return make_content(volume);
}

/// Draws the box with `options` and checks its centre pixel.
template <typename T>
void expect_picture(const std::string& options, const std::vector<Layer>& layers) {
  const std::string told = options + ", " + name_of(voxel_type_of<T>());
  const AtlasContent content = layered_box<T>(layers);
  Camera camera = Camera::of(NamedView::kSuperior);
  camera.zoom = std::max(1.0, static_cast<double>(layers.size()) / 5);
  const Picture picture = render_or_throw(
      content, selection_of("box(" + options + ")", content.graph), camera,
      {.size = {9, 9}, .quality = Quality::kDraft, .hybrid_shading = false, .termination_threshold = 1e-4f});
  double transmittance = 1;  // in drafts each layer is its own slab
  double radiance = 0;
  for (const Layer& layer : layers) {
    const double passes = std::exp2(-layer.halvings);
    radiance += transmittance * (1 - passes) * layer.shade;
    transmittance *= passes;
  }
  // Pixels may terminate at a transmittance of 1e-4.
  EXPECT_NEAR(picture.at(4, 4)[3], 1 - transmittance, 1.1e-4) << told;
  EXPECT_NEAR(picture.at(4, 4)[0], radiance, 1.1e-4) << told;
  if (transmittance > 1e-3) {
    EXPECT_NEAR(picture.at(4, 4)[3], 1 - transmittance, 1e-6) << told;
    EXPECT_NEAR(picture.at(4, 4)[0], radiance, 1e-6) << told;
  }
}

/// Transmittance 1/2 at 10, and 1/4 with half the shade at 20.
constexpr const char* kPeak = "curve=0:0/10:0.5/20:0.75:0.5/30:0";

TEST(TransferPicture, CurvesOfBytes) {
  expect_picture<std::uint8_t>(kPeak, {{10, 1}, {20, 2, 0.5}, {5, 0.5}});
  expect_picture<std::uint8_t>(kPeak, {{0, 0}, {15, 1.5, 0.75}, {30, 0}, {255, 0}});
  expect_picture<std::uint8_t>(kPeak, {{25, 1, 0.75}, {29, 0.2, 0.95}, {1, 0.1}});
  expect_picture<std::int8_t>("curve=-100:0.5/-50:0", {{-128, 1}, {-100, 1}, {-75, 0.5}, {-50, 0}, {127, 0}});
}

TEST(TransferPicture, CurvesOfNegativeShortValues) {
  const char* const bone = "curve=-1000:0/-500:0.5:0.5/1000:0.5";
  expect_picture<std::int16_t>(bone, {{-32768, 0}, {-1000, 0}, {-750, 0.5, 0.75}, {-500, 1, 0.5}});
  expect_picture<std::int16_t>(bone, {{250, 1, 0.75}, {1000, 1}, {32767, 1}, {-600, 0.8, 0.6}});
}

TEST(TransferPicture, CurvesOfFloatsWithNaNAndInfinities) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const std::vector<Layer> layers{
      {nan, 1, 0.5}, {-infinity, 1, 0.5}, {0.25, 1.25, 0.625}, {infinity, 2}, {1e30, 2}};
  expect_picture<float>("curve=0:0.5:0.5/1:0.75", layers);
  expect_picture<double>("curve=0:0.5:0.5/1:0.75", layers);
  // If the first point is transparent, so is not-a-number.
  expect_picture<float>(kPeak, {{nan, 0}, {10, 1}, {nan, 0}, {infinity, 0}});
}

TEST(TransferPicture, LongValues) {
  expect_picture<std::uint32_t>("curve=4e9:0/4.2e9:0.75", {{4.1e9, 1}, {4e9, 0}, {4.2e9, 2}});
  expect_picture<std::int32_t>("curve=-2e9:0.5/2e9:0", {{-2.1e9, 1}, {0, 0.5}, {2e9, 0}});
}

TEST(TransferPicture, OnePointIsTheSameForEveryValue) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expect_picture<std::uint8_t>("curve=40:0.5:0.25", {{0, 1, 0.25}, {40, 1, 0.25}, {255, 1, 0.25}});
  expect_picture<float>("curve=40:0.5:0.25", {{nan, 1, 0.25}, {-1e9, 1, 0.25}});
}

TEST(TransferPicture, StepsAreAllOrNothing) {
  // Over the window from 0 to 100, and between two given ends.
  expect_picture<std::uint8_t>("profile=hard,opacity=0.5",
                               {{49, 0}, {51, 1, 0.6325}, {0, 0}, {100, 1}, {200, 1}, {50, 0.5, 0.625}});
  expect_picture<std::int16_t>("profile=hard,opacity=0.5,low=-300,high=-100",
                               {{-301, 0}, {-202, 0}, {-150, 1, 0.8125}, {-100, 1}, {5, 1}});
  expect_picture<double>("curve=1:0/1.0000000000000002:0.5",
                         {{1, 0}, {1 + std::numeric_limits<double>::epsilon(), 1}});
}

TEST(TransferPicture, RampsAndTheirDefaults) {
  const double soft = -std::log2(1 - 0.3);
  const double thin = -std::log2(1 - 0.01);
  const double hard = -std::log2(1 - 0.95);
  expect_picture<std::uint8_t>("low=50", {{75, soft / 2, 0.625}, {50, 0}, {255, soft}});
  expect_picture<std::uint8_t>("high=50", {{25, soft / 2, 0.625}, {50, soft}, {0, 0}});
  expect_picture<std::uint8_t>("profile=thin,low=10,high=20", {{15, thin / 2, 0.625}, {20, thin}});
  expect_picture<std::uint8_t>("profile=hard,low=10,high=20", {{12, 0}, {18, hard, 0.85}});
  expect_picture<std::uint8_t>("low=150", {{200, soft / 2, 0.625}, {250, soft}});
}

/// Four structures side by side in every scanline, three voxels wide each, with one grey value.
TEST(TransferPicture, NeighboursHaveCurvesOfTheirOwn) {
  TestVolume volume;
  volume.grid.size = {12, 5, 1};
  for (const std::int64_t s : {0, 1, 2, 3}) {
    volume.structures.push_back(
        {fmt::format("s{}", s), make_mask(volume.grid.size, [s](auto i, auto, auto) { return i / 3 == s; })});
  }
  volume.values = make_values(VoxelType::kUInt16, std::vector<std::uint16_t>(60, 600));
  volume.window_low = 0;
  volume.window_high = 1200;
  const AtlasContent content = make_content(volume);
  const Selection selection = selection_of(
      "s0(opacity=0.75) + s1(curve=600:0.25:0.25) + s2(low=700) + s3(profile=hard,high=1000,opacity=0.9)",
      content.graph);
  const std::array<Layer, 4> expected{
      {{600, 1, 0.625}, {600, -std::log2(0.75), 0.25}, {600, 0}, {600, -std::log2(0.1), 0.7}}};
  for (std::size_t s = 0; s < expected.size(); ++s) {
    Camera camera = Camera::of(NamedView::kSuperior);
    camera.center_lps_mm = Vec3{3.0 * static_cast<double>(s) + 1, 2, 0};
    camera.zoom = zoom_for(content.display, 9, 0.1);  // within the centre of the central voxel
    const Picture picture =
        render_or_throw(content, selection, camera, {.size = {9, 9}, .hybrid_shading = false});
    const double opacity = 1 - std::exp2(-expected[s].halvings);
    EXPECT_NEAR(picture.at(4, 4)[3], opacity, 1e-6) << s;
    EXPECT_NEAR(picture.at(4, 4)[0], opacity * expected[s].shade, 1e-6) << s;
  }
}

}  // namespace
}  // namespace splatlas
