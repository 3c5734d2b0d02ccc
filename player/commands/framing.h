// Framing of a picture on the command line: --fit, --center and --scene.
#pragma once

#include <optional>
#include <string>
#include <variant>

#include "format/atlas_reader.h"
#include "player/camera.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace splatlas {

/// Middle of the picture: that of the fit, a point in LPS mm, or a name of the selection language.
using FrameCenter = std::variant<std::monostate, Vec3, std::string>;

/// Adds --view, whose directions replace the camera.
CLI::Option* add_view(CLI::App& command, Camera& camera, const std::string& help = "");

/// Adds the options. Parsing fills `fits_selection` and `center`, which must outlive the command.
void add_framing(CLI::App& command, bool& fits_selection, FrameCenter& center);

/// The scene of a name, in any case. kNotFound with the names that the atlas has.
[[nodiscard]] Result<Scene> find_scene(const std::string& name, const Atlas& atlas);

/// The point of a centre; none for that of the fit. kNotFound for unknown names; kFailed for structures
/// without voxels.
[[nodiscard]] Result<std::optional<Vec3>> center_of(const FrameCenter& center, const Atlas& atlas);

}  // namespace splatlas
