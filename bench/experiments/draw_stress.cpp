#include "bench/experiments/draw_stress.h"

#include <algorithm>
#include <cmath>

#include "bench/measure/frames.h"
#include "tests/support/random_scene.h"

namespace splatlas {
namespace {

constexpr float kRounding = 1e-5f;

void draw(Renderer& renderer, const Camera& camera, const RenderOptions& options, StressOutcome& outcome) {
  ++outcome.pictures;
  const Result<Frame> frame = renderer.render(camera, options);
  if (frame) {
    inspect(frame->picture, outcome);
  } else {
    ++outcome.refused;
  }
}

/// In both projections and classifications.
void draw_all_modes(Renderer& renderer, Camera camera, RenderOptions options, StressOutcome& outcome) {
  for (const CameraProjection projection : {CameraProjection::kParallel, CameraProjection::kPerspective}) {
    for (const Classification classification : {Classification::kBefore, Classification::kAfter}) {
      camera.projection = projection;
      options.classification = classification;
      draw(renderer, camera, options, outcome);
    }
  }
}

}  // namespace

StressOutcome& StressOutcome::operator+=(const StressOutcome& other) {
  pictures += other.pictures;
  pixels += other.pixels;
  refused += other.refused;
  nan_pixels += other.nan_pixels;
  unphysical += other.unphysical;
  return *this;
}

void inspect(const Picture& picture, StressOutcome& outcome) {
  for (std::size_t n = 0; n < picture.rgba.size(); n += 4) {
    ++outcome.pixels;
    const float* pixel = &picture.rgba[n];
    if (!std::all_of(pixel, pixel + 4, [](float value) { return std::isfinite(value); })) {
      ++outcome.nan_pixels;
      continue;
    }
    const float alpha = pixel[3];
    const bool physical =
        alpha >= -kRounding && alpha <= 1 + kRounding && std::all_of(pixel, pixel + 3, [&](float value) {
          return value >= -kRounding && value <= alpha + kRounding;
        });
    if (!physical) ++outcome.unphysical;
  }
}

StressOutcome draw_stress(const StressInput& input) {
  StressOutcome outcome;
  Renderer renderer(open_in_memory(input.content), {.threads = 1});
  for (const std::string& text : input.selections) {
    const Result<Selection> selection = Selection::parse(text, input.content.graph);
    if (!selection || !renderer.select(*selection)) {
      ++outcome.pictures;
      ++outcome.refused;
      continue;
    }
    for (RenderOptions options : input.options) {
      for (const NamedQuality& quality : kQualities) {
        options.quality = quality.quality;
        for (const Camera& camera : input.cameras) draw_all_modes(renderer, camera, options, outcome);
      }
    }
  }
  return outcome;
}

StressOutcome draw_random_scenes(std::uint32_t count) {
  StressOutcome outcome;
  for (std::uint32_t number = 0; number < count; ++number) {
    const RandomScene scene = random_scene(number);
    Renderer renderer(open_in_memory(scene.content), {.threads = 1});
    if (!renderer.select(scene.selection)) {
      ++outcome.pictures;
      ++outcome.refused;
      continue;
    }
    draw_all_modes(renderer, scene.camera, scene.options, outcome);
  }
  return outcome;
}

}  // namespace splatlas
