// Pictures of random scenes: every instruction set against the scalar reference kernels.
#include "tests/support/every_kernel.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "player/frame/render_overrides.h"
#include "tests/support/random_scene.h"

namespace splatlas {
namespace {

bool has_adaptive_rays(const RandomScene& scene) {
  const bool by_rays = scene.camera.projection == CameraProjection::kPerspective ||
                       scene.options.classification == Classification::kAfter;
  return by_rays && scene.options.quality != Quality::kDraft;
}

class PicturesOf : public EveryKernel {};
INSTANTIATE_TEST_SUITE_P(Every, PicturesOf, testing::ValuesIn(kernel_targets()), kernel_name);

TEST_P(PicturesOf, RandomScenesAgreeWithTheScalarReference) {
  int compared = 0, adaptive = 0;
  for (std::uint32_t number = 400; number < 800; ++number) {
    RandomScene scene = whole_scene(11, number);
    scene.options.termination_threshold = 0;
    Renderer renderer(open_in_memory(scene.content), {.threads = 1});
    ASSERT_TRUE(renderer.select(scene.selection));
    const Result<Picture> reference = render_with(renderer, scene.camera, scene.options, {.simd = false});
    const Result<Picture> picture = renderer.render(scene.camera, scene.options);
    ASSERT_EQ(picture.has_value(), reference.has_value());
    if (!reference) continue;  // an invalid view
    double largest = 0;
    for (std::size_t n = 0; n < reference->rgba.size(); ++n) {
      const double difference =
          static_cast<double>(picture->rgba[n]) - static_cast<double>(reference->rgba[n]);
      largest = std::max(largest, std::abs(difference));
    }
    EXPECT_LE(largest, 2e-5) << number << ": " << describe(scene);
    ++compared;
    adaptive += has_adaptive_rays(scene) ? 1 : 0;
  }
  EXPECT_GT(compared, 350);
  EXPECT_GT(adaptive, 50);
}

}  // namespace
}  // namespace splatlas
