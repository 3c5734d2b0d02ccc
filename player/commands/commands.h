// Commands of splatlas-player: render, export, and ATLAS alone, which plays it in the browser. Framing of a
// picture on the command line: --fit, --center and --scene; the opening picture of a page.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "format/atlas_reader.h"
#include "format/content/cut_planes.h"
#include "format/result.h"
#include "player/camera.h"
#include "player/camera_moves.h"
#include "player/render_page.h"

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

/// An error in a selection, with the atlas. If it is of a `scene`, the file is at fault: kInvalidAtlas.
[[nodiscard]] Error in_selection(const Error& error, const Atlas& atlas, const std::string& scene);

struct OpeningRequest {
  std::string select;  ///< empty: of the first scene, or everything
  std::string scene;   ///< name; empty: none
  Camera camera;
  bool names_view = false;  ///< --view is given, and the direction is that of the camera
};

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

/// Arguments of the render command.
struct RenderRequest {
  std::filesystem::path atlas, output;  ///< output "-": a PNG to standard output
  bool all_scenes = false;              ///< --scenes: the output is the folder of a handout
  double turn_deg = 0;
  std::size_t frames = 0;  ///< of a turn, to a folder; 0: one picture
  std::string select = "*";
  std::string scene;  ///< name; empty: none
  Camera camera;
  FrameCenter center;
  PageOptions page;
  std::array<std::optional<Rgb>, 2> background{Rgb{0, 0, 0}};  ///< top, bottom; none: transparent, as the top
  bool distinct_colors = false;  ///< Atlas::distinct_colors() in place of the atlas's colours
  RendererOptions renderer;
  AtlasOptions atlas_options;
  std::filesystem::path stats;    ///< JSON file; empty: none
  std::filesystem::path ids;      ///< id image; empty: none
  std::filesystem::path depth;    ///< depth map; empty: none
  bool names_caps = false;        ///< --cap is given
  bool names_projection = false;  ///< --projection is given

  [[nodiscard]] bool is_folder() const { return all_scenes || frames > 0; }
};

/// Arguments of the export command.
struct ExportRequest {
  std::vector<std::filesystem::path> atlases;  ///< one, unless `site` is given
  std::filesystem::path html, site;            ///< one of them
  OpeningRequest opening;
};

/// Arguments without a command.
struct PlayRequest {
  std::filesystem::path atlas;
  RendererOptions renderer;
  AtlasOptions atlas_options;
  std::uint16_t port = 0;  ///< 0: any
  bool no_browser = false;
};

/// Adds a command, or the options of none. Parsing fills `request`, which must outlive `app`. Invalid values
/// throw CLI::ValidationError with option, value and remedy.
CLI::App* add_render(CLI::App& app, RenderRequest& request);
CLI::App* add_export(CLI::App& app, ExportRequest& request);
void add_play(CLI::App& app, PlayRequest& request);

/// Lines to report after a picture.
struct RenderReport {
  std::vector<std::string> warnings, notes;
  std::vector<std::string> missing;  ///< unreadable parts of a damaged atlas
};

/// Renders a picture and writes it, with statistics, id image and depth map if requested, or a folder of
/// pictures: all files or none. Renders the intact parts of a damaged atlas. Errors name the file.
[[nodiscard]] Result<RenderReport> run_render(const RenderRequest& request, const RenderControl& control);

/// Writes the page, or the folder of the site: all or nothing. Refuses damaged atlases. Errors name the file.
[[nodiscard]] Result<void> run_export(const ExportRequest& request);

/// Prints the address, and serves until ten seconds after the last page has closed, or until SIGINT, SIGTERM
/// or SIGHUP. kInvalidAtlas at the end if pictures lacked damaged parts. Call it before threads start.
[[nodiscard]] Result<void> play(const PlayRequest& request);

}  // namespace splatlas
