#include "player/commands/option_names.h"

#include <algorithm>
#include <array>

namespace splatlas {

std::optional<NamedView> named_view(std::string_view name) {
  constexpr std::array<std::string_view, 6> kNames{"anterior", "posterior", "left",
                                                   "right",    "superior",  "inferior"};
  const auto* found = std::find(kNames.begin(), kNames.end(), name);
  if (found == kNames.end()) return std::nullopt;
  return static_cast<NamedView>(found - kNames.begin());
}

std::optional<CameraProjection> named_projection(std::string_view name) {
  if (name == "parallel") return CameraProjection::kParallel;
  if (name == "perspective") return CameraProjection::kPerspective;
  return std::nullopt;
}

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
