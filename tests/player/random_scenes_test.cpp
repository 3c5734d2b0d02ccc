// Random scenes against the references: what the renderer computes, and the truth.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <span>
#include <string>

#include <gtest/gtest.h>

#include "player/frame/render_overrides.h"
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
  auto picture = render_with(renderer, scene.camera, scene.options, scene.overrides);
  EXPECT_TRUE(picture.has_value()) << (picture ? "" : picture.error().message);
  return picture ? *picture : Picture{};
}

/// The renderer differs from its own model in double precision by float rounding alone.
TEST(RandomScenes, EqualTheDiscreteModel) {
  double largest = 0;
  for (std::uint32_t n = 0; n < scene_count(); ++n) {
    RandomScene scene = random_scene(n);
    scene.options.termination_threshold = 0;
    scene.options.antialiasing = false;
    const Picture picture = render_scene(scene);
    const auto model = reference::render_model({scene.content, scene.selection, scene.camera, scene.options});
    const auto d = reference::difference(picture, model);
    EXPECT_LE(d.largest, 2e-5) << "scene " << n << ": " << describe(scene) << ": " << to_text(d);
    EXPECT_LE(reference::energy_violation(picture), 1e-6) << "scene " << n << ": " << describe(scene);
    largest = std::max(largest, d.largest);
  }
  RecordProperty("largest", std::to_string(largest));
}

double distance(std::span<const float> pixel, const std::array<double, 4>& expected) {
  double most = 0;
  for (std::size_t c = 0; c < 4; ++c) most = std::max(most, std::abs(pixel[c] - expected[c]));
  return most;
}

/// Every pixel has either one sample, or is the mean of the quality's pattern: there is nothing in between.
TEST(RandomScenes, AntialiasedPixelsAreTheMeanOfTheirSamples) {
  std::size_t antialiased = 0;
  for (std::uint32_t n = 0; n < scene_count(); n += 6) {
    RandomScene scene = random_scene(n);
    scene.options.termination_threshold = 0;
    const Picture picture = render_scene(scene);
    const reference::ReferenceScene of_reference{scene.content, scene.selection, scene.camera, scene.options};
    const std::size_t samples = scene.options.quality == Quality::kDraft    ? 1
                                : scene.options.quality == Quality::kNormal ? 4
                                                                            : 8;
    const auto centers = reference::render_model(of_reference);
    const auto means = reference::render_model(of_reference, sample_pattern(samples));
    for (std::size_t p = 0; p < centers.pixels.size(); ++p) {
      const auto pixel = std::span(picture.rgba).subspan(4 * p, 4);
      const double from_center = distance(pixel, centers.pixels[p]);
      const double from_mean = distance(pixel, means.pixels[p]);
      ASSERT_LE(std::min(from_center, from_mean), 2e-5)
          << "scene " << n << ": " << describe(scene) << ", pixel " << p;
      if (from_center > 2e-5) ++antialiased;
    }
    EXPECT_LE(reference::energy_violation(picture), 1e-6) << "scene " << n << ": " << describe(scene);
  }
  EXPECT_GT(antialiased, scene_count());
}

}  // namespace
}  // namespace splatlas
