// Camera moves of interactive viewers: orbit, pan, zoom about a point; box of a selection; cuts and centre of
// a scene. All functions are thread-safe, and O(1) unless a comment gives their cost.
#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "format/atlas_reader.h"
#include "format/content/cut_planes.h"
#include "format/content/selection.h"
#include "player/camera.h"

namespace splatlas {

/// Orbits by angles in degrees. Wraps the azimuth to (-180, 180] and clamps the elevation to [-90, 90]. A
/// camera beyond these limits can only return towards them.
[[nodiscard]] Camera turned(const Camera& camera, double azimuth_deg, double elevation_deg);
/// Orbits by a drag of (dx, dy) pixels. The side that faces the viewer follows the pointer. A drag across the
/// smaller picture side is a turn of 180 degrees.
[[nodiscard]] Camera turned_by_drag(const Camera& camera, double dx, double dy, const PictureSize& size);

/// Pans by a drag of (dx, dy) pixels: points in the plane of the centre stay under the pointer. Returns the
/// camera unchanged if parallel_view() fails.
[[nodiscard]] Camera moved_by_drag(const Camera& camera, double dx, double dy, const PictureSize& size,
                                   const Display& display);

/// Zooms by a factor about the centre. Clamps the zoom to [kMinZoom, kMaxZoom].
[[nodiscard]] Camera zoomed(const Camera& camera, double factor);
/// The same about picture coordinates (x, y): their point in the plane of the centre is fixed. Returns the
/// camera zoomed about the centre if parallel_view() fails.
[[nodiscard]] Camera zoomed_at(const Camera& camera, double factor, double x, double y,
                               const PictureSize& size, const Display& display);

/// Bounding box of the voxels of the selected structures, as of box_lps_mm(); none without voxels. Cost: the
/// draw plan of the selection, and O(1) per selected class; reads nothing from the file.
[[nodiscard]] std::optional<std::pair<Vec3, Vec3>> bounding_box(const Atlas& atlas,
                                                                const Selection& selection);

/// The point of a centre; none for that of the fit. kNotFound for unknown names; kFailed for structures
/// without voxels. Thread-safe, linear in the classes.
[[nodiscard]] Result<std::optional<Vec3>> center_of(const FrameCenter& center, const Atlas& atlas);

/// Cuts, centre and labels of a scene.
struct SceneFraming {
  CutPlanes cuts;
  std::optional<Vec3> center_lps_mm;    ///< none: the middle of the selection
  std::vector<StructureIndex> bearers;  ///< of labels; empty: every structure has its own name
};

/// Of each structure the one of these names (StructureGraph::find_named()) whose label it bears: itself, or
/// its nearest group among them; else kNoStructure. kNotFound for unknown names. Linear in the structures.
[[nodiscard]] Result<std::vector<StructureIndex>> label_bearers(const StructureGraph& graph,
                                                                std::span<const std::string> names);

/// Reads the texts of a scene. kInvalidAtlas for bad ones, with the atlas and the scene. Thread-safe.
[[nodiscard]] Result<SceneFraming> framing_of(const Scene& scene, const Atlas& atlas);

}  // namespace splatlas
