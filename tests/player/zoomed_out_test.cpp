#include <cmath>
#include <tuple>
#include <utility>

#include <gtest/gtest.h>

#include "player/render/view/shear.h"
#include "tests/reference/picture_difference.h"
#include "tests/reference/reference_picture.h"
#include "tests/support/phantom_content.h"
#include "tests/support/random_scene.h"
#include "tests/support/render.h"
#include "tests/support/test_content.h"

namespace splatlas {
namespace {

/// RMS of the differences between a picture and the means of a finer one over its pixels, in 1/255.
double difference_of_means(const Picture& picture, const Picture& fine) {
  const int factor = fine.size.width / picture.size.width;
  double sum = 0;
  for (int y = 0; y < picture.size.height; ++y) {
    for (int x = 0; x < picture.size.width; ++x) {
      for (std::size_t c = 0; c < 4; ++c) {
        double mean = 0;
        for (int n = 0; n < factor * factor; ++n)
          mean += static_cast<double>(fine.at(factor * x + n % factor, factor * y + n / factor)[c]);
        const double difference = static_cast<double>(picture.at(x, y)[c]) - mean / (factor * factor);
        sum += difference * difference;
      }
    }
  }
  return 255 * std::sqrt(sum / static_cast<double>(picture.rgba.size()));
}

/// Views with more than one ray a pixel.
TEST(ZoomedOut, PicturesByRaysAreTheMeansOfTheirPixels) {
  int coarse = 0;
  for (std::uint32_t number = 0; number < 60; ++number) {
    RandomScene scene = random_scene(number);
    for (StructureDraw& draw : scene.selection.structures) {
      if (draw.mode != DrawMode::kOff) draw.mode = DrawMode::kVolume;
    }
    scene.content.values = {};  // the reference knows no post-classification
    scene.options.classification = Classification::kAfter;
    scene.options.quality = Quality::kHigh;
    scene.options.size = {12, 10};
    scene.options.termination_threshold = 0;
    const ParallelView view = *parallel_view(scene.camera, scene.options.size, scene.content.display);
    const auto voxels = factorise(view, storage_grid(scene.content)).voxels_per_pixel();
    if (std::ranges::max(voxels) <= 1 || std::ranges::max(voxels) > 20) continue;
    const auto rays = [](double of_pixel) {
      return of_pixel > 1 ? static_cast<int>(std::ceil(1.5 * of_pixel)) : 1;
    };
    SCOPED_TRACE(testing::Message() << number << ": " << describe(scene));
    Renderer renderer = renderer_of(scene.content, scene.selection);
    const Frame frame = frame_or_throw(renderer, scene.camera, scene.options, scene.overrides);
    if (frame.stats.voxels_visited == 0) continue;
    ++coarse;
    const reference::ReferencePicture truth = reference::render_mean_truth(
        {scene.content, scene.selection, scene.camera, scene.options}, rays(voxels[0]), rays(voxels[1]));
    EXPECT_LE(255 * reference::difference(frame.picture, truth).rms, 0.01);
  }
  EXPECT_GT(coarse, 10);
}

/// A translucent plane across a noisy volume: rays of a pixel meet it at one depth.
TEST(ZoomedOut, VolumesAroundSurfacesAreMeansByRays) {
  TestVolume volume;
  volume.grid.size = {40, 40, 40};
  SurfaceMesh plane;
  plane.positions_ijk = {{0, 19.5f, 0}, {39, 19.5f, 0}, {0, 19.5f, 39}, {39, 19.5f, 39}};
  plane.normals_lps.assign(4, {0, 1, 0});
  plane.triangles = {{0, 1, 2}, {1, 3, 2}};
  volume.structures = {
      {"noise",
       make_mask(volume.grid.size, [](auto i, auto, auto k) { return (i * 7919 + k * 1299709) % 7 < 3; })},
      {"plane", {}, {0, 0, 255}, {}, plane}};
  const AtlasContent content = make_content(volume);
  const Selection selection =
      selection_of("noise:volume(opacity=0.05) + plane:surface(opacity=0.4)", content.graph);
  const Camera camera{.azimuth_deg = 2, .elevation_deg = 1, .zoom = zoom_for(content.display, 8, 4)};
  const RenderOptions options{.size = {8, 8},
                              .quality = Quality::kHigh,
                              .hybrid_shading = false,
                              .antialiasing = false,
                              .termination_threshold = 0};
  const Picture picture = render_or_throw(content, selection, camera, options);
  const reference::ReferencePicture truth =
      reference::render_mean_truth({content, selection, camera, options}, 6);
  EXPECT_LE(255 * reference::difference(picture, truth).rms, 0.2);
}

TEST(ZoomedOut, NormalPicturesOfVolumesAreTheMeansOfTheirPixels) {
  const AtlasContent content = phantom_content();
  for (const auto& [text, at_2_mm, at_4_mm] : {std::tuple("*:volume(opacity=0.3)", 0.18, 0.06),
                                               {"*:volume(profile=thin,opacity=0.02)", 0.02, 0.01},
                                               {"*:volume(profile=hard,opacity=0.95)", 1.2, 0.3},
                                               {"*:volume(curve=0:0/250:0.4)", 0.25, 0.08}}) {
    for (const auto& [mm_per_pixel, bound] : {std::pair(2, at_2_mm), {4, at_4_mm}}) {
      SCOPED_TRACE(testing::Message() << text << ", pixels of " << mm_per_pixel << " mm");
      Renderer renderer = renderer_of(content, selection_of(text, content.graph));
      const Camera camera{
          .azimuth_deg = 30, .elevation_deg = 20, .zoom = zoom_for(content.display, 24, mm_per_pixel)};
      const Picture picture = render_or_throw(renderer, camera, {.size = {24, 24}});
      const Picture fine = render_or_throw(renderer, camera, {.size = {192, 192}, .quality = Quality::kHigh});
      EXPECT_LT(difference_of_means(picture, fine), bound);
    }
  }
}

}  // namespace
}  // namespace splatlas
