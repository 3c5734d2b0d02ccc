#include <gtest/gtest.h>

#include "player/renderer.h"
#include "tests/reference/picture_difference.h"
#include "tests/support/render.h"
#include "tests/support/test_content.h"

namespace splatlas {
namespace {

/// Spans of 1 to 40 voxels along x, too far apart to be joined, in 6 rows and 4 slices.
AtlasContent striped_content() {
  std::vector<bool> scanline;
  for (std::size_t length = 1; length <= 40; ++length) {
    scanline.insert(scanline.end(), length, true);
    scanline.insert(scanline.end(), 2 * static_cast<std::size_t>(kBlock), false);
  }
  TestVolume volume;
  volume.grid.size = {static_cast<std::int64_t>(scanline.size()), 6, 4};
  volume.structures = {
      {"stripes",
       make_mask(volume.grid.size,
                 [&](std::int64_t i, auto, auto) { return scanline[static_cast<std::size_t>(i)]; }),
       {255, 128, 64}}};
  return make_content(volume);
}

/// A span clipped by the picture must not read beyond its clipped part.
TEST(Sheets, CutSpansAtTheBordersOfThePicture) {
  const AtlasContent content = striped_content();
  Renderer renderer(open_in_memory(content), {1, 0});
  const Selection selection = selection_of("stripes", content.graph);
  ASSERT_TRUE(renderer.select(selection));
  const RenderOptions options{.size = {24, 8}};
  Camera camera;
  camera.zoom = content.display.radius_mm * 2 / 0.96 / 8;  // one voxel per pixel
  double shown = 0;
  for (double x = 10.25; x < static_cast<double>(content.source_grid.size[0]); x += 11.5) {
    camera.center_lps_mm = Vec3{x, 2.5, 1.5};
    const Picture picture = render_or_throw(renderer, camera, options);
    const auto model = reference::render_model({content, selection, camera, options});
    const auto difference = reference::difference(picture, model);
    EXPECT_LE(difference.largest, 1e-6) << "centre " << x << ": " << to_text(difference);
    for (std::size_t n = 3; n < picture.rgba.size(); n += 4) shown += picture.rgba[n];
  }
  EXPECT_GT(shown, 500);
}

}  // namespace
}  // namespace splatlas
