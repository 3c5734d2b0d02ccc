#include "player/render_options.h"

namespace splatlas {

std::optional<Quality> named_quality(std::string_view name) {
  if (name == "draft") return Quality::kDraft;
  if (name == "normal") return Quality::kNormal;
  if (name == "high") return Quality::kHigh;
  return std::nullopt;
}

std::optional<Classification> named_classification(std::string_view name) {
  if (name == "before") return Classification::kBefore;
  if (name == "after") return Classification::kAfter;
  return std::nullopt;
}

std::optional<DepthCue> named_depth_cue(std::string_view name) {
  if (name == "none") return DepthCue::kNone;
  if (name == "edges") return DepthCue::kEdges;
  return std::nullopt;
}

}  // namespace splatlas
