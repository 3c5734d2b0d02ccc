// Random scenes against the references: what the renderer computes, and the truth.
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>

#include "tests/reference/picture_difference.h"
#include "tests/support/random_scene.h"

namespace splatlas {
namespace {

/// A few hundred in every run; set the variable to look longer.
std::uint32_t scene_count() {
  const char* wanted = std::getenv("SPLATLAS_RANDOM_SCENES");
  return wanted != nullptr ? static_cast<std::uint32_t>(std::stoul(wanted)) : 300;
}

Picture render_scene(const RandomScene& scene, unsigned threads = 1) {
  Renderer renderer(open_in_memory(scene.content), {threads, 0});
  EXPECT_TRUE(renderer.select(scene.selection).has_value());
  auto picture = renderer.render(scene.camera, scene.options);
  EXPECT_TRUE(picture.has_value()) << (picture ? "" : picture.error().message);
  return picture ? *picture : Picture{};
}

/// The renderer differs from its own model in double precision by float rounding alone.
TEST(RandomScenes, EqualTheDiscreteModel) {
  double largest = 0;
  for (std::uint32_t n = 0; n < scene_count(); ++n) {
    RandomScene scene = random_scene(n);
    scene.options.transmittance_floor = 0;
    const Picture picture = render_scene(scene);
    const auto model = reference::render_model({scene.content, scene.selection, scene.camera, scene.options});
    const auto d = reference::difference(picture, model);
    EXPECT_LE(d.largest, 2e-5) << "scene " << n << ": " << describe(scene) << ": " << to_text(d);
    EXPECT_LE(reference::energy_violation(picture), 1e-6) << "scene " << n << ": " << describe(scene);
    largest = std::max(largest, d.largest);
  }
  RecordProperty("largest", std::to_string(largest));
}

}  // namespace
}  // namespace splatlas
