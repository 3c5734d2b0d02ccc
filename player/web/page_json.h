// Contents of an atlas and states of a page to draw, as JSON; warnings of what shows less than expected.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "format/atlas_reader.h"
#include "format/content/decision_tree.h"
#include "format/content/selection.h"
#include "format/result.h"
#include "player/camera.h"
#include "player/render_options.h"
#include "player/renderer.h"

namespace splatlas {

/// JSON document, safe to print, with grid, structures in the order of their indices, counts, sizes, named
/// views and scenes. Cost: that of subtree_counts(). Thread-safe.
[[nodiscard]] std::string info_json(const Atlas& atlas);

/// [structure]: voxels and triangles of it and its descendants.
[[nodiscard]] std::vector<SubtreeCounts> counts_of(const Atlas& atlas);

struct PageFit {
  int structure = -1;                                ///< index; -1: the whole selection
  double zoom = 1;                                   ///< relative to the fit
  std::optional<Vec3> center_lps_mm = std::nullopt;  ///< in place of the middle
  std::optional<PictureSize> size = std::nullopt;    ///< of the picture to fit; none: that of the state
};

/// A camera, or its fit, and the options of a picture.
struct PageState {
  Camera camera;
  std::optional<PageFit> fit;
  RenderOptions options;
};

/// Reads {size: [width, height], quality, camera: {azimuth, elevation, zoom, center, projection, fieldOfView,
/// fit: {structure, zoom, center, size}}, select, palette, cuts: [{normal, offset}], caps, depthCue, shading,
/// draftBudget, ids, depths}: degrees, LPS mm and ms. All but the size have the defaults of Camera and
/// RenderOptions. kUsage for values that these do not have; throws nlohmann::json::exception for other types.
[[nodiscard]] Result<PageState> page_state_of(const nlohmann::ordered_json& json);
/// True for palette "distinct", false for "atlas" or none.
[[nodiscard]] Result<bool> wants_distinct_colors(const nlohmann::ordered_json& json);

/// The camera as in a state, without a fit.
[[nodiscard]] nlohmann::ordered_json json_of(const Camera& camera);

/// A line for each term of a selection that later ones hide, up to a limit.
[[nodiscard]] Result<std::vector<std::string>> selection_warnings(std::span<const SelectionTerm> terms,
                                                                  const Atlas& atlas);

/// Why a picture shows nothing; empty if it shows something.
[[nodiscard]] std::string emptiness_of(const Frame& frame);

}  // namespace splatlas
