// Whole pictures of random scenes, by every instruction set and by the scalar twins.
#include "tests/support/every_kernel.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "player/frame/render_overrides.h"
#include "tests/support/random_scene.h"

namespace splatlas {
namespace {

bool has_tolerance(const RandomScene& scene) {
  const bool by_rays = scene.camera.projection == CameraProjection::kPerspective ||
                       scene.options.classification == Classification::kAfter;
  return by_rays && scene.options.quality != Quality::kDraft;
}

/// What march_kernels.h and splat_kernels.h promise, with the tolerances of docs/rendering.md.
double max_difference(const RandomScene& scene) {
  if (!has_tolerance(scene)) return 2e-5;
  return scene.options.quality == Quality::kNormal ? 4 * 0.054 : 4 * 0.0046;
}

class PicturesOf : public EveryKernel {};
INSTANTIATE_TEST_SUITE_P(Every, PicturesOf, testing::ValuesIn(kernel_targets()), kernel_name);

TEST_P(PicturesOf, RandomScenesAgreeWithTheScalarTwins) {
  int compared = 0, with_tolerance = 0;
  for (std::uint32_t number = 400; number < 800; ++number) {
    RandomScene scene = whole_scene(11, number);
    scene.options.termination_threshold = 0;
    Renderer renderer(open_in_memory(scene.content), {.threads = 1});
    ASSERT_TRUE(renderer.select(scene.selection));
    const Result<Picture> twin = render_with(renderer, scene.camera, scene.options, {.simd = false});
    const Result<Picture> picture = renderer.render(scene.camera, scene.options);
    ASSERT_EQ(picture.has_value(), twin.has_value());
    if (!twin) continue;  // a view that cannot be had
    double largest = 0;
    for (std::size_t n = 0; n < twin->rgba.size(); ++n) {
      const double difference = static_cast<double>(picture->rgba[n]) - static_cast<double>(twin->rgba[n]);
      largest = std::max(largest, std::abs(difference));
    }
    EXPECT_LE(largest, max_difference(scene)) << number << ": " << describe(scene);
    ++compared;
    with_tolerance += has_tolerance(scene) ? 1 : 0;
  }
  EXPECT_GT(compared, 350);
  EXPECT_GT(with_tolerance, 50);
}

}  // namespace
}  // namespace splatlas
