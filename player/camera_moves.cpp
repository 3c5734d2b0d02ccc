#include "player/camera_moves.h"

#include <algorithm>
#include <variant>

#include <fmt/format.h>

#include "format/result_macros.h"
#include "format/text/ascii_text.h"

namespace splatlas {
namespace {

constexpr double kDegreesPerSide = 180;

/// Centre of the bounding box of the named structures' voxels.
Result<Vec3> center_of(const std::string& name, const Atlas& atlas) {
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<StructureIndex> named, atlas.graph().find_named(name));
  Selection selection{std::vector<StructureDraw>(atlas.graph().size())};
  for (const StructureIndex s : atlas.graph().descendants(named)) {
    selection.structures[s].mode = DrawMode::kVolume;
  }
  const auto box = bounding_box(atlas, selection);
  if (!box) return fail(ErrorCode::kFailed, "{} has no voxels; name another structure", in_quotes(name));
  Vec3 center{};
  for (std::size_t a = 0; a < 3; ++a) center[a] = 0.5 * (box->first[a] + box->second[a]);
  return center;
}

}  // namespace

Camera turned(const Camera& camera, double azimuth_deg, double elevation_deg) {
  Camera result = camera;
  result.azimuth_deg = std::remainder(camera.azimuth_deg + azimuth_deg, 360.0);
  if (result.azimuth_deg <= -180) result.azimuth_deg += 360;
  // An elevation beyond the poles can only return towards them
  const double from = camera.elevation_deg;
  result.elevation_deg = std::clamp(from + elevation_deg, std::min(-90.0, from), std::max(90.0, from));
  return result;
}

Camera turned_by_drag(const Camera& camera, double dx, double dy, const PictureSize& size) {
  const double degrees_per_pixel = kDegreesPerSide / std::max(1, std::min(size.width, size.height));
  return turned(camera, -dx * degrees_per_pixel, dy * degrees_per_pixel);
}

Camera moved_by_drag(const Camera& camera, double dx, double dy, const PictureSize& size,
                     const Display& display) {
  const auto view = parallel_view(camera, size, display);
  if (!view) return camera;
  Camera result = camera;
  Vec3 center = view->center_lps_mm;
  for (std::size_t a = 0; a < 3; ++a) {
    center[a] += (-dx * view->right_lps[a] + dy * view->up_lps[a]) * view->mm_per_pixel;
  }
  result.center_lps_mm = center;
  return result;
}

Camera zoomed(const Camera& camera, double factor) {
  Camera result = camera;
  result.zoom = std::clamp(camera.zoom * factor, kMinZoom, kMaxZoom);
  return result;
}

Camera zoomed_at(const Camera& camera, double factor, double x, double y, const PictureSize& size,
                 const Display& display) {
  const Camera result = zoomed(camera, factor);
  const double drag = result.zoom / camera.zoom - 1;
  return moved_by_drag(result, drag * (size.width / 2.0 - x), drag * (size.height / 2.0 - y), size, display);
}

std::optional<std::pair<Vec3, Vec3>> bounding_box(const Atlas& atlas, const Selection& selection) {
  IndexBox box;
  for (const ClassDraw& draw : atlas.tree().plan(selection).classes)
    box.include(atlas.classes().box(draw.id));
  if (box.empty()) return std::nullopt;
  return box_lps_mm(atlas.grid(), box.first, box.last);
}

Result<std::optional<Vec3>> center_of(const FrameCenter& center, const Atlas& atlas) {
  if (const auto* point = std::get_if<Vec3>(&center)) return std::optional(*point);
  const auto* name = std::get_if<std::string>(&center);
  if (name == nullptr) return std::nullopt;
  SPLATLAS_ASSIGN_OR_RETURN(const Vec3 point, center_of(*name, atlas));
  return std::optional(point);
}

Result<std::vector<StructureIndex>> label_bearers(const StructureGraph& graph,
                                                  std::span<const std::string> names) {
  std::vector<StructureIndex> bearers(graph.size(), kNoStructure);
  for (const std::string& name : names) {
    SPLATLAS_ASSIGN_OR_RETURN(const auto named, graph.find_named(name));
    for (const StructureIndex s : named) bearers[s] = s;
  }
  for (const StructureIndex s : graph.topological()) {
    for (const StructureIndex parent : graph[s].parents)
      if (bearers[s] == kNoStructure) bearers[s] = bearers[parent];
  }
  return bearers;
}

Result<SceneFraming> framing_of(const Scene& scene, const Atlas& atlas) {
  const auto in_scene = [&](const Error& error) {
    return Error{ErrorCode::kInvalidAtlas,
                 fmt::format("{}: scene {}: {}", atlas.name(), in_quotes(scene.name), error.message),
                 {}};
  };
  SceneFraming framing;
  SPLATLAS_ASSIGN_OR_RETURN(framing.cuts, parse_cuts(scene.cuts).map_error(in_scene));
  if (!scene.labels.empty()) {
    SPLATLAS_ASSIGN_OR_RETURN(framing.bearers,
                              label_bearers(atlas.graph(), scene.labels).map_error(in_scene));
  }
  if (scene.center.empty()) return framing;
  const auto center = parse_center(scene.center);
  if (!center)
    return fail(ErrorCode::kInvalidAtlas, "{}: scene {}: centre {} is no point within reach", atlas.name(),
                in_quotes(scene.name), in_quotes(scene.center));
  SPLATLAS_ASSIGN_OR_RETURN(framing.center_lps_mm, center_of(*center, atlas).map_error(in_scene));
  return framing;
}

}  // namespace splatlas
