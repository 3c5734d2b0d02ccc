#include "player/frame/frame_settings.h"

#include <algorithm>

namespace splatlas {
namespace {

/// Bytes of the rasteriser and the volume pass per fragment, for samples with a single fragment.
constexpr std::size_t kBytesPerFragment = 200;
/// Bytes per pixel of edge detection.
constexpr std::uint64_t kBytesToFindEdges = 48;
/// Maximum of 32-bit fragment indices.
constexpr std::size_t kMaxFragments = 0xfffffffe;

std::uint64_t pixels_of(const PictureSize& size) {
  return static_cast<std::uint64_t>(size.width) * static_cast<std::uint64_t>(size.height);
}

std::size_t edge_samples(const RenderOptions& options, std::uint64_t max_memory_bytes) {
  if (!options.antialiasing || options.quality == Quality::kDraft) return 1;
  if (pixels_of(options.size) > max_memory_bytes / 4 / kBytesToFindEdges) return 1;
  return options.quality == Quality::kNormal ? kFourSamples.size() : kEightSamples.size();
}

}  // namespace

bool cues_depth(const RenderOptions& options) {
  return options.depth_cue == DepthCue::kEdges && options.depth_cue_strength > 0;
}

std::uint64_t frame_bytes(const RenderOptions& options) {
  return picture_bytes(options.size) + (cues_depth(options) ? pixels_of(options.size) * sizeof(float) : 0);
}

RasterOptions raster_options(const RenderOptions& options, std::uint64_t max_memory_bytes) {
  const std::size_t max_fragments =
      std::min<std::size_t>(max_memory_bytes / 4 / kBytesPerFragment, kMaxFragments);
  return {max_fragments, termination_threshold(options), edge_samples(options, max_memory_bytes)};
}

CastOptions cast_options(const RenderOptions& options, const RenderOverrides& overrides) {
  CastOptions cast{.termination_threshold = termination_threshold(options),
                   .principal_axis = overrides.principal_axis};
  switch (options.quality) {
    case Quality::kDraft: break;
    case Quality::kNormal:
      cast.max_steps = 32;
      cast.tolerance = 0.054f;
      break;
    case Quality::kHigh:
      cast.min_steps = 8;
      cast.max_steps = 64;
      cast.tolerance = 0.0046f;
      break;
  }
  return cast;
}

}  // namespace splatlas
