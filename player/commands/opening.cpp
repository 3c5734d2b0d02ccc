#include "player/commands/opening.h"

#include <algorithm>
#include <vector>

#include <nlohmann/json.hpp>

#include "format/result_macros.h"
#include "format/text/json_text.h"
#include "player/commands/framing.h"
#include "player/web/page_state.h"

namespace splatlas {

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
