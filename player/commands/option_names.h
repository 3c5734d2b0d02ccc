// Names of views, projections, qualities and other choices on the command line.
#pragma once

#include <optional>
#include <string_view>

#include "player/camera.h"
#include "player/render_options.h"

namespace splatlas {

/// "anterior", "posterior", "left", "right", "superior", "inferior".
[[nodiscard]] std::optional<NamedView> named_view(std::string_view name);
/// "parallel", "perspective".
[[nodiscard]] std::optional<CameraProjection> named_projection(std::string_view name);
/// "draft", "normal", "high".
[[nodiscard]] std::optional<Quality> named_quality(std::string_view name);
/// "before", "after".
[[nodiscard]] std::optional<Classification> named_classification(std::string_view name);
/// "none", "edges".
[[nodiscard]] std::optional<DepthCue> named_depth_cue(std::string_view name);

}  // namespace splatlas
