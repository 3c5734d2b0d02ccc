#include "bench/thread_bits.h"

#include "bench/frames.h"
#include "format/selection.h"
#include "format/system/result_macros.h"

namespace splatlas {
namespace {

constexpr PictureSize kSize{253, 211};  // no multiple of bands, vectors or packets

constexpr const char* kVolume = "Brain:volume(opacity=0.3)";
constexpr const char* kHard = "Head:volume(profile=hard)";
constexpr const char* kSurfaces = "\"Left hemisphere\":surface(opacity=0.5) + Cerebellum:surface";
constexpr const char* kHybrid =
    "\"Left hemisphere\":both(opacity=0.4) + \"Right hemisphere\":surface(opacity=0.4) + Cerebellum:surface";

Camera camera_of(int view, CameraProjection projection) {
  Camera camera;
  camera.azimuth_deg = 31 + 25 * view;
  camera.elevation_deg = 19 + 12 * view;
  camera.projection = projection;
  return camera;
}

Result<std::vector<Picture>> pictures_with(const std::shared_ptr<const Atlas>& atlas, const DrawingMode& mode,
                                           unsigned threads, int views) {
  Renderer renderer(atlas, {.threads = threads});
  SPLATLAS_ASSIGN_OR_RETURN(const Selection selection, select(mode.selection, atlas->graph()));
  SPLATLAS_RETURN_IF_ERROR(renderer.select(selection));
  std::vector<Picture> pictures;
  for (int view = 0; view < views; ++view) {
    SPLATLAS_ASSIGN_OR_RETURN(Picture picture,
                              renderer.render(camera_of(view, mode.projection), mode.options));
    pictures.push_back(std::move(picture));
  }
  return pictures;
}

}  // namespace

std::vector<DrawingMode> drawing_modes() {
  using enum CameraProjection;
  const auto with = [](Quality quality, Classification classification = Classification::kBefore) {
    RenderOptions options;
    options.size = kSize;
    options.quality = quality;
    options.classification = classification;
    return options;
  };
  RenderOptions edges = with(Quality::kNormal);
  edges.depth_cue = DepthCue::kEdges;
  return {
      {"draft", kVolume, kParallel, with(Quality::kDraft)},
      {"normal", kVolume, kParallel, with(Quality::kNormal)},
      {"high", kVolume, kParallel, with(Quality::kHigh)},
      {"hard, normal", kHard, kParallel, with(Quality::kNormal)},
      {"classified after", kHard, kParallel, with(Quality::kNormal, Classification::kAfter)},
      {"perspective", kVolume, kPerspective, with(Quality::kNormal)},
      {"perspective, post-classified", kHard, kPerspective, with(Quality::kNormal, Classification::kAfter)},
      {"surfaces", kSurfaces, kParallel, with(Quality::kNormal)},
      {"surfaces, perspective", kSurfaces, kPerspective, with(Quality::kNormal)},
      {"hybrid", kHybrid, kParallel, with(Quality::kNormal)},
      {"hybrid, perspective", kHybrid, kPerspective, with(Quality::kNormal)},
      {"depth cue", kHybrid, kParallel, edges},
      {"depth cue, perspective", kHybrid, kPerspective, edges},
  };
}

Result<std::uint64_t> thread_bits_differ(const std::shared_ptr<const Atlas>& atlas, const DrawingMode& mode,
                                         std::span<const unsigned> threads, int views) {
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<Picture> expected, pictures_with(atlas, mode, 1, views));
  std::uint64_t differ = 0;
  for (const unsigned count : threads) {
    SPLATLAS_ASSIGN_OR_RETURN(const std::vector<Picture> pictures, pictures_with(atlas, mode, count, views));
    for (std::size_t n = 0; n < pictures.size(); ++n) {
      differ += bits_differ(pictures[n].rgba, expected[n].rgba);
    }
  }
  return differ;
}

}  // namespace splatlas
