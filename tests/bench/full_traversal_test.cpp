#include "bench/full_traversal.h"

#include <algorithm>
#include <cstring>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "format/atlas_writer.h"
#include "player/render_frame.h"
#include "tests/format/random_content.h"

namespace splatlas {
namespace {

std::shared_ptr<const Atlas> open_content(const AtlasContent& content) {
  WriteOptions options;
  options.level = 1;
  auto bytes = encode_atlas(content, options);
  if (!bytes) throw std::runtime_error(bytes.error().message);
  auto atlas = Atlas::open_bytes(*std::move(bytes));
  if (!atlas) throw std::runtime_error(atlas.error().message);
  return *atlas;
}

bool same_bits(const Picture& a, const Picture& b) {
  return a.rgba.size() == b.rgba.size() &&
         std::memcmp(a.rgba.data(), b.rgba.data(), a.rgba.size() * sizeof(float)) == 0;
}

bool shows_something(const Picture& picture) {
  return std::any_of(picture.rgba.begin(), picture.rgba.end(), [](float value) { return value > 0; });
}

RC_GTEST_PROP(FullTraversal, DrawsThePlayersPictureBitForBit, ()) {
  auto random = *random_source();
  AtlasContent content = random_content(random, {.max_side = 24});
  content.display.center_lps_mm = index_to_lps_mm(storage_grid(content)).apply({6, 6, 6});
  content.display.radius_mm = 30;
  const auto atlas = open_content(content);
  const auto model = read_voxel_model(*atlas);
  RC_ASSERT(model.has_value());
  FullTraversal full(atlas, *model, 2);
  Renderer player(atlas, {.threads = 1});
  std::size_t seen = 0;
  for (int n = 0; n < 6; ++n) {
    const Selection selection = random_selection(atlas->graph(), random);
    full.select(selection);
    RC_ASSERT(player.select(selection).has_value());
    Camera camera;
    camera.azimuth_deg = 77.0 * n + 5;
    camera.elevation_deg = n % 3 * 35.0 - 35;
    RenderOptions options;
    options.size = {40, 30};
    options.hybrid_shading = n % 2 == 0;
    const auto expected = player.render(camera, options);
    const auto frame = full.render(camera, options);
    RC_ASSERT(expected.has_value());
    RC_ASSERT(frame.has_value());
    RC_ASSERT(same_bits(frame->picture, *expected));
    RC_ASSERT(frame->drawn.voxels_visited == player.stats().voxels_visited);
    RC_ASSERT(frame->drawn.triangles == player.stats().triangles);
    seen += shows_something(*expected);
  }
  RC_CLASSIFY(seen > 0, "something is seen");
}

}  // namespace
}  // namespace splatlas
