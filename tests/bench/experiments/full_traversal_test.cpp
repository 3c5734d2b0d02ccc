#include "bench/experiments/full_traversal.h"

#include <algorithm>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "player/renderer.h"
#include "tests/format/random_content.h"
#include "tests/support/test_content.h"

namespace splatlas {
namespace {

RC_GTEST_PROP(FullTraversal, DrawsThePlayersPictureBitForBit, ()) {
  auto random = *random_source();
  AtlasContent content = random_content(random, {.max_side = 24});
  content.display.center_lps_mm = index_to_lps_mm(storage_grid(content)).apply({6, 6, 6});
  content.display.radius_mm = 30;
  const auto atlas = open_in_memory(content);
  const auto model = read_voxel_model(*atlas);
  RC_ASSERT(model.has_value());
  FullTraversal full(atlas, *model, 2);
  Renderer player(atlas, {.threads = 1});
  std::size_t seen = 0;
  for (int n = 0; n < 6; ++n) {
    const Selection selection = random_selection(atlas->graph(), random);
    full.select(selection);
    RC_ASSERT(player.select(selection).has_value());
    const Camera camera{.azimuth_deg = 77.0 * n + 5, .elevation_deg = n % 3 * 35.0 - 35};
    const RenderOptions options{.size = {40, 30}, .hybrid_shading = n % 2 == 0};
    const auto expected = player.render(camera, options);
    const auto frame = full.render(camera, options);
    RC_ASSERT(expected.has_value());
    RC_ASSERT(frame.has_value());
    RC_ASSERT(bits_differ(frame->picture.rgba, expected->picture.rgba) == 0u);
    RC_ASSERT(frame->drawn.voxels_visited == expected->stats.voxels_visited);
    RC_ASSERT(frame->drawn.triangles == expected->stats.triangles);
    seen += std::ranges::any_of(expected->picture.rgba, [](float value) { return value > 0; });
  }
  RC_CLASSIFY(seen > 0, "something is seen");
}

}  // namespace
}  // namespace splatlas
