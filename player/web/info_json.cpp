#include "player/web/info_json.h"

#include <nlohmann/json.hpp>

#include "format/text/json_text.h"
#include "player/camera.h"
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

Json display_json(const Display& display) {
  return {{"window", {display.window_low, display.window_high}},
          {"center_lps_mm", display.center_lps_mm},
          {"radius_mm", display.radius_mm}};
}

Json views_json() {
  Json json;
  for (const ViewAngles& view : kViewAngles)
    json.push_back({{"name", view.name}, {"azimuth", view.azimuth_deg}, {"elevation", view.elevation_deg}});
  return json;
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
  json["display"] = display_json(atlas.display());
  json["views"] = views_json();
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

}  // namespace splatlas
