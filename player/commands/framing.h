// Framing of a picture on the command line: --fit, --center and --scene; the opening picture of a page.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "format/atlas_reader.h"
#include "format/content/cut_planes.h"
#include "player/camera.h"
#include "player/camera_moves.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace splatlas {

/// Adds --view, whose directions replace the camera.
CLI::Option* add_view(CLI::App& command, Camera& camera, const std::string& help = "");

/// Adds the options. Parsing fills `fits_selection` and `center`, which must outlive the command.
void add_framing(CLI::App& command, bool& fits_selection, FrameCenter& center);

/// The scene of a name, in any case. kNotFound with the names that the atlas has.
[[nodiscard]] Result<Scene> find_scene(const std::string& name, const Atlas& atlas);

/// An error in a selection, with the atlas. That of a scene is a fault of the file: kInvalidAtlas. `scene` is
/// empty for the user's.
[[nodiscard]] Error in_selection(const Error& error, const Atlas& atlas, const std::string& scene);

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
