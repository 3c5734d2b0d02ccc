// Antialiased edges of surfaces, against closed forms and supersampled ground truth.
#include <cmath>

#include <gtest/gtest.h>

#include "player/render/surfaces/edge_pixels.h"
#include "player/render/surfaces/rasterize.h"
#include "tests/reference/picture_difference.h"
#include "tests/support/render.h"

namespace splatlas {
namespace {

/// A ball, and a box half inside it.
AtlasContent ball_and_box() {
  TestVolume volume;
  volume.grid.size = {17, 17, 17};
  volume.structures = {{"ball", ball_mask(volume.grid.size, {8, 8, 8}, 36), {200, 80, 40}},
                       {"box", box_mask(volume.grid.size, {10, 4, 10}, {16, 8, 16}), {40, 90, 220}}};
  return make_content(volume);
}

/// The error falls to less than half with 4 samples, and further with 8.
TEST(Antialiasing, ComesCloserToTheMeanOfThePixel) {
  const AtlasContent content = ball_and_box();
  const Camera camera{.azimuth_deg = 33, .elevation_deg = 21};
  for (const char* selected :
       {"ball:surface + box:surface", "ball:surface(opacity=0.4) + box:surface(opacity=0.6)"}) {
    const Selection selection = selection_of(selected, content.graph);
    RenderOptions options{.size = {56, 56}};
    const auto truth = reference::render_mean_truth({content, selection, camera, options}, 6);
    const auto error = [&](Quality quality, bool antialiasing) {
      options.quality = quality;
      options.antialiasing = antialiasing;
      const Picture picture = render_or_throw(content, selection, camera, options);
      return 255 * reference::difference(picture, truth).rms;
    };
    const double aliased = error(Quality::kNormal, false);
    const double four = error(Quality::kNormal, true);
    const double eight = error(Quality::kHigh, true);
    EXPECT_LT(four, 0.5 * aliased) << selected;
    EXPECT_LT(eight, 0.9 * four) << selected;
  }
}

/// Without an edge nothing changes, to the bit. Drafts are never antialiased.
TEST(Antialiasing, LeavesTheInsideAsItIs) {
  const AtlasContent content = ball_and_box();
  const Selection selection = selection_of("ball:surface", content.graph);
  RenderOptions options{.size = {64, 64}};
  const Picture with = render_or_throw(content, selection, {}, options);
  options.antialiasing = false;
  const Picture without = render_or_throw(content, selection, {}, options);
  const auto differs = [&](int x, int y, int other_x, int other_y) {
    if (other_x < 0 || other_y < 0 || other_x >= 64 || other_y >= 64) return false;
    const auto a = without.at(x, y);
    const auto b = without.at(other_x, other_y);
    for (std::size_t c = 0; c < 4; ++c) {
      if (std::abs(a[c] - b[c]) > kEdgeContrast) return true;
    }
    return false;
  };
  std::size_t changed = 0;
  for (int n = 0; n < 64 * 64; ++n) {
    const int x = n % 64;
    const int y = n / 64;
    if (with.at(x, y) == without.at(x, y)) continue;
    ++changed;
    EXPECT_TRUE(differs(x, y, x - 1, y) || differs(x, y, x + 1, y) || differs(x, y, x, y - 1) ||
                differs(x, y, x, y + 1))
        << x << ", " << y;
  }
  EXPECT_GT(changed, 60u);
  EXPECT_LT(changed, 1000u);
  options.quality = Quality::kDraft;
  const Picture draft = render_or_throw(content, selection, {}, options);
  options.antialiasing = true;
  EXPECT_EQ(render_or_throw(content, selection, {}, options).rgba, draft.rgba);
}

/// An edge moves across a pixel in steps of 1/16. The pixel follows its coverage to 1/8.
TEST(Antialiasing, FollowsTheCoveredShareOfAPixel) {
  SurfaceMesh mesh;
  mesh.normals_lps.assign(3, {0, -1, 0});
  mesh.triangles = {{0, 1, 2}};
  const Grid grid{{16, 16, 16}, {1, 1, 1}, {0, 0, 0}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
  const Camera camera{.center_lps_mm = Vec3{0, 0, 0}};
  ParallelView view = *parallel_view(camera, {8, 8}, Display{});
  view.mm_per_pixel = 1;
  ThreadPool pool(1);
  const Lighting lighting(view);
  for (int step = 0; step <= 16; ++step) {
    const float right = static_cast<float>(step) / 16;  // edge of the triangle, mm right of the middle
    mesh.positions_ijk = {{right, 0, -50}, {right, 0, 50}, {right - 60, 0, 0}};
    const SurfaceClusters clusters(mesh, grid);
    const SurfaceDraw surface{&mesh, &clusters, 0, {1, 1, 1}, 0.5f};
    FragmentList list;
    const RasterScene scene = raster_scene({&surface, 1}, view, factorise(view, grid), grid, lighting);
    ASSERT_TRUE(Rasterizer().draw(scene, {.edge_samples = 8}, list, pool));
    double covered = 0;
    int samples = 0;
    for (std::size_t n = 0; n < list.sample_count(); ++n) {
      if (list.samples[n].pixel != 4 * 8 + 4) continue;
      covered += static_cast<double>(list.of_sample(n).size());
      ++samples;
    }
    ASSERT_EQ(samples, 8) << step;
    EXPECT_NEAR(covered / samples, right, 1.0 / 8) << step;
  }
}

TEST(Antialiasing, GivesTheSameBitsWithAnyNumberOfThreads) {
  const AtlasContent content = ball_and_box();
  const Selection selection = selection_of("ball:both(opacity=0.3) + box:surface", content.graph);
  (void)render_with_threads(content, selection, {}, {.size = {90, 70}, .quality = Quality::kHigh});
}

TEST(Antialiasing, CountsItsSamplesAmongTheFragments) {
  const AtlasContent content = ball_and_box();
  const Grid grid = storage_grid(content);
  const SurfaceClusters clusters(content.surfaces[0], grid);
  const SurfaceDraw surface{&content.surfaces[0], &clusters, 0, {1, 1, 1}, 0.5f};
  const ParallelView view = *parallel_view({}, {64, 64}, content.display);
  const Lighting lighting(view);
  const RasterScene scene = raster_scene({&surface, 1}, view, factorise(view, grid), grid, lighting);
  ThreadPool pool(2);
  FragmentList list;
  ASSERT_TRUE(Rasterizer().draw(scene, {.edge_samples = 1}, list, pool));
  const std::size_t without = list.fragments.size();
  ASSERT_TRUE(Rasterizer().draw(scene, {.edge_samples = 4}, list, pool));
  EXPECT_GT(list.fragments.size(), without);
  const auto refused = Rasterizer().draw(scene, {.max_fragments = without, .edge_samples = 4}, list, pool);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kLimit);
}

}  // namespace
}  // namespace splatlas
