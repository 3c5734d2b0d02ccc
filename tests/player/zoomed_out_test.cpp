#include <cmath>
#include <tuple>
#include <utility>

#include <gtest/gtest.h>

#include "tests/support/phantom_content.h"
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
