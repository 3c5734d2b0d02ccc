// Random scenes of one renderer each, with the checks of splatlas-random-scenes.
#include <algorithm>
#include <array>

#include <gtest/gtest.h>

#include "tests/scenes/check_scene.h"

namespace splatlas {
namespace {

SceneReport expect_no_faults(std::uint32_t number, const RandomScene& scene, const SceneChecks& checks) {
  SceneReport report = check_scene(scene, checks);
  for (const std::string& fault : report.faults)
    ADD_FAILURE() << "scene " << number << ": " << describe(scene) << ": " << fault;
  return report;
}

TEST(RandomScenes, SheetsEqualTheDiscreteModel) {
  constexpr std::uint32_t kScenes = 300;
  std::size_t antialiased = 0;
  for (std::uint32_t n = 0; n < kScenes; ++n)
    antialiased += expect_no_faults(n, random_scene(n), {.thorough = n % 6 == 0}).antialiased;
  EXPECT_GT(antialiased, kScenes);
}

/// A volume without surfaces. The eye may lie inside it.
RandomScene volume_scene(std::uint32_t number) {
  RandomScene scene = random_scene(number, 9);
  for (StructureDraw& draw : scene.selection.structures) {
    if (draw.mode != DrawMode::kOff) draw.mode = DrawMode::kVolume;
  }
  scene.options.size.width = std::min(scene.options.size.width, 14);
  scene.options.size.height = std::min(scene.options.size.height, 14);
  scene.options.hybrid_shading = false;
  scene.options.classification = Classification::kAfter;
  if (number % 3 != 0) {
    scene.camera.projection = CameraProjection::kPerspective;
    scene.camera.field_of_view_deg = std::array{0.01, 30.0, 75.0, 120.0, 170.0}[number % 5];
  }
  return scene;
}

TEST(RandomScenes, RaysThroughVolumesEqualTheReference) {
  for (std::uint32_t n = 0; n < 60; ++n)
    expect_no_faults(n, volume_scene(n), {.thorough = true, .max_visible_rms = 0.5});
}

}  // namespace
}  // namespace splatlas
