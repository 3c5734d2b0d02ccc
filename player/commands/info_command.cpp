#include "player/commands/info_command.h"

#include <nlohmann/json.hpp>

#include "format/derive/subtree_counts.h"
#include "format/text/json_text.h"

namespace splatlas {
namespace {

using Json = nlohmann::ordered_json;

Json grid_json(const Grid& grid) {
  return {{"size", grid.size},
          {"spacing_mm", grid.spacing_mm},
          {"origin_lps_mm", grid.origin_lps_mm},
          {"direction_lps", grid.direction_lps}};
}

std::vector<SubtreeCounts> counts_of(const Atlas& atlas) {
  std::vector<std::uint64_t> triangles(atlas.graph().size());
  for (StructureIndex s = 0; s < triangles.size(); ++s) triangles[s] = atlas.triangles(s);
  return subtree_counts(atlas.graph(), atlas.classes(), atlas.tree(), triangles);
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

}  // namespace

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
  json["scenes"] = Json::array();
  for (const Scene& scene : atlas.scenes()) {
    json["scenes"].push_back({{"name", scene.name},
                              {"caption", scene.caption},
                              {"select", scene.selection},
                              {"azimuth", scene.azimuth_deg},
                              {"elevation", scene.elevation_deg},
                              {"zoom", scene.zoom}});
  }
  const Provenance& provenance = atlas.provenance();
  json["provenance"] = {{"title", provenance.title},
                        {"citation", provenance.citation},
                        {"licence", provenance.licence},
                        {"tool", provenance.tool}};
  return json_text(json);
}

PrintableText info_text(const Atlas& atlas) {
  PrintableText text;
  const Grid& grid = atlas.source_grid();
  text.add("{}: atlas {}, {} bytes\n", atlas.name(), atlas.format_version(), atlas.counters().file);
  if (!atlas.provenance().title.empty()) text.add("title     {}\n", atlas.provenance().title);
  text.add("grid      {} x {} x {} voxels of {:g} x {:g} x {:g} mm, values {}\n", grid.size[0], grid.size[1],
           grid.size[2], grid.spacing_mm[0], grid.spacing_mm[1], grid.spacing_mm[2],
           name_of(atlas.value_type()));
  text.add("classes   {}\nruns      x {}, y {}, z {}\nsections ", atlas.classes().size(),
           atlas.runs(Axis::kX), atlas.runs(Axis::kY), atlas.runs(Axis::kZ));
  const char* separator = "";
  for (const SectionSize& section : atlas.sections()) {
    text.add("{} {} {}", separator, section.name, section.bytes);
    separator = ",";
  }
  if (!atlas.scenes().empty()) text.add("\nscenes    {}", in_quotes(atlas.scenes().front().name));
  for (std::size_t n = 1; n < atlas.scenes().size(); ++n) text.add(", {}", in_quotes(atlas.scenes()[n].name));
  text.add("\n\n{:<50} {:>10} {:>10} {:>10}\n", "structure (again under every parent)", "interior",
           "boundary", "triangles");
  // Depth first with an explicit stack; a structure appears under each of its parents.
  constexpr std::size_t kMaxLines = 10000;
  const std::vector<SubtreeCounts> counts = counts_of(atlas);
  std::size_t lines = 0;
  std::vector<std::pair<StructureIndex, std::size_t>> stack;
  const auto roots = atlas.graph().roots();
  for (auto root = roots.rbegin(); root != roots.rend(); ++root) stack.emplace_back(*root, 0);
  while (!stack.empty() && lines < kMaxLines) {
    const auto [s, depth] = stack.back();
    stack.pop_back();
    ++lines;
    const std::string label = std::string(2 * depth, ' ') + atlas.graph()[s].name;
    text.add("{:<50} {:>10} {:>10} {:>10}", label, counts[s].interior, counts[s].boundary,
             counts[s].triangles);
    for (const Term& term : atlas.graph()[s].terms) text.add("  {} {}", term.vocabulary, term.value);
    text.add("\n");
    const auto children = atlas.graph().children(s);
    for (auto child = children.rbegin(); child != children.rend(); ++child)
      stack.emplace_back(*child, depth + 1);
  }
  if (!stack.empty()) text.add("... (more than {} lines; --json lists every structure once)\n", kMaxLines);
  return text;
}

}  // namespace splatlas
