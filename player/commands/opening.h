// Opening picture of a page.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "format/atlas_reader.h"
#include "player/camera.h"
#include "player/camera_moves.h"

namespace splatlas {

/// Command-line options of the opening picture.
struct OpeningRequest {
  std::string select;  ///< empty: of the first scene, or everything
  std::string scene;   ///< name; empty: none
  Camera camera;
  bool names_view = false;  ///< --view is given, and the direction is that of the camera
};

/// The opening picture of a page.
struct Opening {
  std::string select = "*", caption = {};
  Camera camera = {};
  bool is_fitted = false;  ///< else the page fits the camera, and zooms
  double zoom = 1;
  SceneFraming framing = {};
  std::optional<std::size_t> scene = std::nullopt;
};

/// kNotFound for a scene that the atlas has not. Thread-safe.
[[nodiscard]] Result<Opening> opening_of(const OpeningRequest& request, const Atlas& atlas);

/// For HtmlPage::opening.
[[nodiscard]] std::string json_of(const Opening& opening);

}  // namespace splatlas
