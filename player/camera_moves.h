// Camera moves of interactive viewers: orbit, pan, zoom about a point, fit to a box.
#pragma once

#include <optional>

#include "format/atlas_reader.h"
#include "format/selection.h"
#include "player/camera.h"

namespace splatlas {

/// Limits of zoomed_at() and fitted().
inline constexpr double kMinZoom = 0.1;
inline constexpr double kMaxZoom = 60;

/// Orbits by angles; azimuth kept in (-180, 180], elevation in [-90, 90].
[[nodiscard]] Camera turned(const Camera& camera, double azimuth_deg, double elevation_deg);
/// Orbits by a drag of (dx, dy) pixels: the side that faces the viewer follows the pointer, half a turn per
/// smaller picture side.
[[nodiscard]] Camera turned_by_drag(const Camera& camera, double dx, double dy, const PictureSize& size);

/// Pans by a drag of (dx, dy) pixels: points in the plane of the centre stay under the pointer. The same
/// camera where it has no view of this size.
[[nodiscard]] Camera moved_by_drag(const Camera& camera, double dx, double dy, const PictureSize& size,
                                   const Display& display);

/// Zooms by a factor about picture coordinates (x, y): the point in the plane of the centre stays there. The
/// same camera where it has no view of this size.
[[nodiscard]] Camera zoomed_at(const Camera& camera, double factor, double x, double y,
                               const PictureSize& size, const Display& display);

/// A box in LPS mm, parallel to its axes.
struct LpsBox {
  Vec3 first, last;
};

/// Bounding box of the voxels of the selected structures; none when they have no voxels. Cost: the plan of
/// the selection; nothing is read.
[[nodiscard]] std::optional<LpsBox> bounding_box(const Atlas& atlas, const Selection& selection);

/// Looks at the middle of the box in the same direction, at the zoom at which the whole box fits into the
/// picture. The same camera where it has no view of this size.
[[nodiscard]] Camera fitted(const Camera& camera, const LpsBox& box, const PictureSize& size,
                            const Display& display);

}  // namespace splatlas
