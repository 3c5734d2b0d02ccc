#include <algorithm>
#include <cstddef>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "format/program/command_options.h"
#include "format/result_macros.h"
#include "format/text/ascii_text.h"
#include "format/text/json_text.h"
#include "player/commands/commands.h"
#include "player/web/page_json.h"

namespace splatlas {

CLI::Option* add_view(CLI::App& command, Camera& camera, const std::string& help) {
  Choices<Camera> views;
  for (std::size_t n = 0; n < kViewAngles.size(); ++n)
    views.emplace_back(kViewAngles[n].name, Camera::of(static_cast<NamedView>(n)));
  return add_choice(command, "--view", camera, views, help);
}

void add_framing(CLI::App& command, bool& fits_selection, FrameCenter& center) {
  add_choice(command, "--fit", fits_selection, {{"selection", true}, {"grid", false}},
             "content of the picture at zoom 1: the selected voxels and surfaces, or the whole atlas");
  add_parsed(command, "--center", center, parse_center,
             fmt::format("must be X,Y,Z in LPS mm, each at most {} from 0, or name a structure", kMaxMm),
             "middle of the picture: a structure (see NAME), or X,Y,Z in LPS mm; the zoom stays");
}

Result<Scene> find_scene(const std::string& name, const Atlas& atlas) {
  constexpr std::size_t kMaxNames = 20;
  std::string names;
  for (const Scene& scene : atlas.scenes()) {
    if (equal_ignoring_case(scene.name, name)) return scene;
    if (&scene - atlas.scenes().data() < static_cast<std::ptrdiff_t>(kMaxNames))
      names += (names.empty() ? "" : ", ") + in_quotes(scene.name);
  }
  if (atlas.scenes().size() > kMaxNames) names += ", ...";
  return fail(ErrorCode::kNotFound, "{}: --scene {}: the atlas has {}", atlas.name(), in_quotes(name),
              names.empty() ? "no scenes; build it with --scene FILE.toml" : "the scenes " + names);
}

Error in_selection(const Error& error, const Atlas& atlas, const std::string& scene) {
  if (scene.empty()) return {error.code, fmt::format("{}: {}", atlas.name(), error.message), {}};
  return {ErrorCode::kInvalidAtlas,
          fmt::format("{}: scene {}: {}", atlas.name(), in_quotes(scene), error.message),
          {}};
}

Result<Opening> opening_of(const OpeningRequest& request, const Atlas& atlas) {
  Opening opening{.camera = request.camera};
  if (!request.select.empty()) opening.select = request.select;
  const std::vector<Scene>& scenes = atlas.scenes();
  const bool is_scene = !request.scene.empty() || (request.select.empty() && !scenes.empty());
  if (!is_scene) return opening;
  SPLATLAS_ASSIGN_OR_RETURN(const Scene scene,
                            find_scene(request.scene.empty() ? scenes.front().name : request.scene, atlas));
  opening.scene = std::ranges::find(scenes, scene.name, &Scene::name) - scenes.begin();
  opening.select = scene.selection;
  opening.caption = scene.question.empty() ? scene.caption : scene.question;
  opening.zoom = scene.zoom;
  if (scene.perspective) opening.camera.projection = CameraProjection::kPerspective;
  SPLATLAS_ASSIGN_OR_RETURN(opening.framing, framing_of(scene, atlas));
  if (!request.names_view) {
    opening.camera.azimuth_deg = scene.azimuth_deg;
    opening.camera.elevation_deg = scene.elevation_deg;
  }
  return opening;
}

std::string json_of(const Opening& opening) {
  const Camera& camera = opening.camera;
  nlohmann::ordered_json json{{"select", opening.select}, {"camera", json_of(camera)}, {"scene", nullptr}};
  nlohmann::ordered_json& placed = json["camera"];
  if (!opening.is_fitted) {
    placed["fit"] = {{"structure", -1}, {"zoom", opening.zoom}};
    if (opening.framing.center_lps_mm) placed["fit"]["center"] = *opening.framing.center_lps_mm;
  }
  if (opening.scene) json["scene"] = *opening.scene;
  return json_text(json, -1);
}

}  // namespace splatlas
