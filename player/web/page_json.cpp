#include "player/web/page_json.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "format/result_macros.h"
#include "format/text/json_text.h"
#include "player/camera_moves.h"

namespace splatlas {
namespace {

using Json = nlohmann::ordered_json;

Json grid_json(const Grid& grid) {
  return {{"size", grid.size},
          {"spacing_mm", grid.spacing_mm},
          {"origin_lps_mm", grid.origin_lps_mm},
          {"direction_lps", grid.direction_lps}};
}

Json structure_json(const Atlas& atlas, StructureIndex s, const SubtreeCounts& counts) {
  const Structure& structure = atlas.graph()[s];
  Json parents = Json::array();
  for (const StructureIndex p : structure.parents) parents.push_back(atlas.graph()[p].id);
  Json json{{"id", structure.id},
            {"name", structure.name},
            {"parents", parents},
            {"color", to_hex(structure.color)},
            {"voxels", {{"interior", counts.interior}, {"boundary", counts.boundary}}},
            {"triangles", counts.triangles}};
  if (structure.label) json["label"] = *structure.label;
  for (const Term& term : structure.terms)
    json["terms"].push_back({{"vocabulary", term.vocabulary}, {"value", term.value}});
  return json;
}

template <typename T>
T value_at(const Json& json, const char* key, T otherwise) {
  const auto found = json.find(key);
  return found == json.end() || found->is_null() ? otherwise : found->get<T>();
}

std::optional<Vec3> point_at(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found == json.end() || found->is_null() ? std::nullopt : std::optional(found->get<Vec3>());
}

/// An error of the value at a key.
tl::unexpected<Error> fault_at(const char* key, const std::string& text) {
  return tl::unexpected(Error{ErrorCode::kUsage, fmt::format("{}: {}", key, text), key});
}

template <typename Enum, std::size_t kCount>
Result<Enum> enum_at(const Json& json, const char* key, const std::array<const char*, kCount>& names,
                     Enum otherwise) {
  const auto name = value_at<std::string>(json, key, names[static_cast<std::size_t>(otherwise)]);
  const auto found = std::ranges::find(names, std::string_view(name));
  if (found == names.end())
    return fault_at(key, fmt::format("{}: must be one of {}", name, fmt::join(names, ", ")));
  return static_cast<Enum>(found - names.begin());
}

constexpr std::array kQualities{"draft", "normal", "high"};
constexpr std::array kCaps{"values", "labels", "both", "none"};
constexpr std::array kProjections{"parallel", "perspective"};

Result<PictureSize> size_of(const Json& json) {
  PictureSize size;
  const Json& sides = json.at("size");
  for (const auto& [side, n] : {std::pair{&size.width, 0}, {&size.height, 1}}) {
    const double pixels = sides.at(static_cast<std::size_t>(n)).get<double>();
    if (!(pixels >= 1 && pixels <= kMaxPictureSide && pixels == std::floor(pixels)))
      return fault_at("size", fmt::format("{}: must be an integer from 1 to {}", pixels, kMaxPictureSide));
    *side = static_cast<int>(pixels);
  }
  return size;
}

Result<PageFit> fit_of(const Json& json) {
  constexpr double kMostStructures = 1e9;
  PageFit fit{
      .structure = static_cast<int>(std::clamp(value_at(json, "structure", -1.0), -1.0, kMostStructures)),
      .zoom = value_at(json, "zoom", 1.0),
      .center_lps_mm = point_at(json, "center")};
  if (json.contains("size")) {
    SPLATLAS_ASSIGN_OR_RETURN(fit.size, size_of(json));
  }
  return fit;
}

Result<Camera> camera_of(const Json& json) {
  Camera camera;
  camera.azimuth_deg = value_at(json, "azimuth", camera.azimuth_deg);
  camera.elevation_deg = value_at(json, "elevation", camera.elevation_deg);
  camera.zoom = value_at(json, "zoom", camera.zoom);
  camera.center_lps_mm = point_at(json, "center");
  camera.field_of_view_deg = value_at(json, "fieldOfView", camera.field_of_view_deg);
  SPLATLAS_ASSIGN_OR_RETURN(camera.projection, enum_at(json, "projection", kProjections, camera.projection));
  return camera;
}

}  // namespace

std::vector<SubtreeCounts> counts_of(const Atlas& atlas) {
  std::vector<std::uint64_t> triangles(atlas.graph().size());
  for (StructureIndex s = 0; s < triangles.size(); ++s) triangles[s] = atlas.triangles(s);
  return subtree_counts(atlas.graph(), atlas.classes(), atlas.tree(), triangles);
}

/// Cuts and centre of a scene with bad texts are left out.
Json scene_json(const Scene& scene, const Atlas& atlas) {
  Json json{{"name", scene.name},           {"question", scene.question},
            {"caption", scene.caption},     {"select", scene.selection},
            {"azimuth", scene.azimuth_deg}, {"elevation", scene.elevation_deg},
            {"zoom", scene.zoom},           {"projection", scene.perspective ? "perspective" : "parallel"},
            {"labels", scene.labels},       {"cuts", Json::array()}};
  const auto framing = framing_of(scene, atlas);
  if (!framing) return json;
  for (const CutPlane& cut : framing->cuts)
    json["cuts"].push_back({{"normal", cut.normal_lps}, {"offset", cut.offset_mm}});
  if (framing->center_lps_mm) json["center"] = *framing->center_lps_mm;
  return json;
}

std::string info_json(const Atlas& atlas) {
  Json json{{"format_version", atlas.format_version()}, {"file_bytes", atlas.counters().file},
            {"grid", grid_json(atlas.source_grid())},   {"storage_grid", grid_json(atlas.grid())},
            {"values", name_of(atlas.value_type())},    {"classes", atlas.classes().size()}};
  for (const Axis axis : kAxes) {
    json["axes"].push_back(
        {{"axis", std::string(1, "xyz"[static_cast<std::size_t>(axis)])}, {"runs", atlas.runs(axis)}});
  }
  json["structures"] = Json::array();
  const std::vector<SubtreeCounts> counts = counts_of(atlas);
  for (StructureIndex s = 0; s < atlas.graph().size(); ++s)
    json["structures"].push_back(structure_json(atlas, s, counts[s]));
  json["sections"] = Json::array();
  for (const SectionSize& section : atlas.sections()) {
    json["sections"].push_back({{"name", section.name}, {"bytes", section.bytes}});
  }
  const Display& display = atlas.display();
  json["display"] = {{"window", {display.window_low, display.window_high}},
                     {"center_lps_mm", display.center_lps_mm},
                     {"radius_mm", display.radius_mm}};
  for (const ViewAngles& view : kViewAngles)
    json["views"].push_back(
        {{"name", view.name}, {"azimuth", view.azimuth_deg}, {"elevation", view.elevation_deg}});
  json["scenes"] = Json::array();
  for (const Scene& scene : atlas.scenes()) json["scenes"].push_back(scene_json(scene, atlas));
  const Provenance& provenance = atlas.provenance();
  json["provenance"] = {{"title", provenance.title},
                        {"citation", provenance.citation},
                        {"licence", provenance.licence},
                        {"tool", provenance.tool}};
  for (const Source& source : provenance.sources)
    json["provenance"]["sources"].push_back({{"role", source.role}, {"hash", source.hash}});
  return json_text(json);
}

Result<PageState> page_state_of(const Json& json) {
  PageState state;
  RenderOptions& options = state.options;
  SPLATLAS_ASSIGN_OR_RETURN(options.size, size_of(json));
  SPLATLAS_ASSIGN_OR_RETURN(options.quality, enum_at(json, "quality", kQualities, options.quality));
  SPLATLAS_ASSIGN_OR_RETURN(options.caps, enum_at(json, "caps", kCaps, options.caps));
  options.depth_cue = value_at(json, "depthCue", false) ? DepthCue::kEdges : DepthCue::kNone;
  options.hybrid_shading = value_at(json, "shading", true);
  options.draft_budget_ms = value_at(json, "draftBudget", 0.0);
  options.ids = value_at(json, "ids", false);
  options.depths = value_at(json, "depths", false);
  for (const Json& cut : value_at(json, "cuts", Json::array()))
    SPLATLAS_RETURN_IF_ERROR(
        options.cuts.add({cut.at("normal").get<Vec3>(), cut.at("offset").get<double>()}));
  const Json camera = value_at(json, "camera", Json::object());
  SPLATLAS_ASSIGN_OR_RETURN(state.camera, camera_of(camera));
  if (const auto fit = camera.find("fit"); fit != camera.end()) {
    SPLATLAS_ASSIGN_OR_RETURN(state.fit, fit_of(*fit));
  }
  return state;
}

Result<bool> wants_distinct_colors(const Json& json) {
  return enum_at(json, "palette", std::array{"atlas", "distinct"}, false);
}

Json json_of(const Camera& camera) {
  Json json{{"azimuth", camera.azimuth_deg}, {"elevation", camera.elevation_deg}, {"zoom", camera.zoom}};
  if (camera.center_lps_mm) json["center"] = *camera.center_lps_mm;
  json["projection"] = kProjections[static_cast<std::size_t>(camera.projection)];
  json["fieldOfView"] = camera.field_of_view_deg;
  return json;
}

Result<std::vector<std::string>> selection_warnings(std::span<const SelectionTerm> terms,
                                                    const Atlas& atlas) {
  constexpr std::size_t kMaxWarnings = 5;
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<HiddenTerm> hidden, find_hidden_terms(terms, atlas.graph()));
  std::vector<std::string> warnings;
  for (const HiddenTerm& term : std::span(hidden).first(std::min(hidden.size(), kMaxWarnings))) {
    warnings.push_back(term.message);
  }
  if (hidden.size() > kMaxWarnings) {
    warnings.push_back(fmt::format("selection: {} more terms are hidden", hidden.size() - kMaxWarnings));
  }
  return warnings;
}

std::string emptiness_of(const Frame& frame) {
  const std::vector<float>& rgba = frame.picture.rgba;
  for (std::size_t n = 3; n < rgba.size(); n += 4) {
    if (rgba[n] > 0) return {};
  }
  const RenderStats& stats = frame.stats;
  if (stats.volume_voxels + stats.surface_voxels + stats.hybrid_voxels == 0 && stats.triangles == 0)
    return "the picture shows nothing: the selection is empty";
  return "the picture shows nothing of the selection: it is transparent, removed by a cut or beside the "
         "picture";
}

}  // namespace splatlas
