// splatlas-error-budget: the error budget of docs/renderer.md, measured per approximation.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "format/program/standard_output.h"
#include "player/render/view/shear.h"
#include "tests/reference/picture_difference.h"
#include "tests/support/render.h"
#include "tests/support/standard_scenes.h"

namespace splatlas::reference {
namespace {

constexpr PictureSize kSize{64, 64};

/// Differences accumulated over views.
struct Budget {
  double squares = 0, largest = 0, mean = 0;
  int views = 0;

  void add(const PictureDifference& d) {
    squares += d.rms * d.rms;
    largest = std::max(largest, d.largest);
    mean += d.mean;
    ++views;
  }
  void print(const std::string& what) const {
    std::printf("| %-44s | %10.5f | %9.4f | %+9.4f |\n", what.c_str(), 255 * std::sqrt(squares / views),
                255 * largest, 255 * mean / views);
  }
};

void measure(const StandardScene& scene) {
  const std::array<const char*, 3> names{"draft", "normal", "high"};
  Renderer renderer = renderer_of(scene.content, scene.selection);
  std::array<Budget, 3> rounding, sheet, slabs, total;
  Budget switched;
  // Axis-parallel, slightly turned, further turned, at 45 degrees to one axis and to two
  for (const auto& [azimuth, elevation] :
       {std::pair(0.0, 0.0), {17.0, 9.0}, {31.0, 24.0}, {45.0, 0.01}, {45.0, 35.26}}) {
    const Camera camera{.azimuth_deg = azimuth, .elevation_deg = elevation};
    ReferenceScene frame{scene.content, scene.selection, camera, {}};
    frame.options.size = kSize;
    frame.options.antialiasing = false;  // compares rays, not pixels
    frame.options.termination_threshold = 0;
    const ReferencePicture truth = render_truth(frame);
    // High quality averages volumes over pixels that are coarser than voxels
    const ParallelView view = *parallel_view(camera, kSize, scene.content.display);
    const bool is_coarse =
        std::ranges::max(factorise(view, storage_grid(scene.content)).voxels_per_pixel()) > 1;
    const bool has_surfaces = !renderer.atlas().tree().plan(scene.selection).surfaces.empty();
    const ReferencePicture mean = is_coarse && !has_surfaces ? render_mean_truth(frame, 8) : truth;
    for (std::size_t q = 0; q < 3; ++q) {
      frame.options.quality = static_cast<Quality>(q);
      const Picture picture = render_or_throw(renderer, frame.camera, frame.options);
      const bool by_rays = frame.options.quality == Quality::kHigh;
      total[q].add(difference(picture, by_rays ? mean : truth));
      if (by_rays) continue;
      const ReferencePicture model = render_model(frame);
      const ReferencePicture unlimited = render_slabs(frame);
      rounding[q].add(difference(picture, model));
      sheet[q].add(difference(model, unlimited));
      slabs[q].add(difference(unlimited, truth));
    }
    if (azimuth == 45) {
      frame.options.quality = Quality::kNormal;
      const auto along = [&](Axis axis) {
        return render_or_throw(renderer, frame.camera, frame.options, {.principal_axis = axis});
      };
      switched.add(difference(along(Axis::kX), along(Axis::kY)));
    }
  }
  std::printf("\n%s\n\n| %-44s | %10s | %9s | %9s |\n|---|---:|---:|---:|\n", scene.name.c_str(),
              "difference, in 1/255", "RMS", "largest", "mean");
  for (const auto& [what, budgets] : {std::pair("float: picture less model, ", &rounding),
                                      {"sheet: model less slabs, ", &sheet},
                                      {"slabs less truth, ", &slabs},
                                      {"in all: picture less truth, ", &total}}) {
    for (std::size_t q = 0; q < (budgets == &total ? 3 : 2); ++q)
      (*budgets)[q].print(std::string(what) + names[q]);
  }
  switched.print("principal axis x less y at 45 degrees, normal");
  std::fflush(stdout);
}

}  // namespace
}  // namespace splatlas::reference

int main() {
  for (const splatlas::StandardScene& scene : {splatlas::phantom_scene(), splatlas::blobs_scene(),
                                               splatlas::labels_scene(), splatlas::hybrid_scene()}) {
    splatlas::reference::measure(scene);
  }
  if (const auto shown = splatlas::finish_standard_output(); !shown) {
    std::fprintf(stderr, "splatlas-error-budget: %s\n", shown.error().message.c_str());
    return splatlas::exit_status(shown.error().code);
  }
  return 0;
}
