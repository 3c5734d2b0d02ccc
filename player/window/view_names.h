// Anatomical names of directions and views.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "player/camera.h"

namespace splatlas {

/// Anatomical letters of a direction in LPS, the strongest first: "L" straight to the left, "LA" between left
/// and anterior. One letter within about 22 degrees of an axis.
[[nodiscard]] std::string orientation_letters(const Vec3& direction_lps);

/// The named view that this camera is turned to, whatever its zoom and centre.
[[nodiscard]] std::optional<NamedView> view_of(const Camera& camera);
/// "Anterior", "Posterior", ...
[[nodiscard]] std::string_view title_of(NamedView view);

}  // namespace splatlas
