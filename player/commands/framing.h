// Framing of a picture on the command line: --fit, --center and --scene.
#pragma once

#include <string>

#include "format/atlas_reader.h"
#include "format/content/frame_center.h"
#include "player/camera.h"

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

}  // namespace splatlas
