// What the mouse and the keys do to the camera, and what the picture's edges are called.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "player/camera.h"

namespace splatlas {

inline constexpr double kMinZoom = 0.1;
inline constexpr double kMaxZoom = 60;

/// Turned by angles; azimuth kept in (-180, 180], elevation in [-90, 90].
[[nodiscard]] Camera turned(const Camera& camera, double azimuth_deg, double elevation_deg);
/// Turned by a drag of (dx, dy) pixels: what faces the viewer follows the pointer, half a turn per picture
/// side.
[[nodiscard]] Camera turned_by_drag(const Camera& camera, double dx, double dy, const PictureSize& size);
/// Zoomed by a factor; what is at picture coordinates (x, y) stays there.
[[nodiscard]] Camera zoomed_at(const Camera& camera, double factor, double x, double y,
                               const PictureSize& size, const Display& display);
/// Moved so that what was under the pointer is under it after a drag of (dx, dy) pixels.
[[nodiscard]] Camera moved_by_drag(const Camera& camera, double dx, double dy, const PictureSize& size,
                                   const Display& display);

/// Anatomical letters of a direction in LPS, the strongest first: "L" straight to the left, "LA" between left
/// and anterior. One letter within about 22 degrees of an axis.
[[nodiscard]] std::string orientation_letters(const Vec3& direction_lps);

/// The named view that this camera is turned to, whatever its zoom and centre.
[[nodiscard]] std::optional<NamedView> view_of(const Camera& camera);
/// "Anterior", "Posterior", ...
[[nodiscard]] std::string_view title_of(NamedView view);

}  // namespace splatlas
