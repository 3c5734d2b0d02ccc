#include "player/commands/info_command.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "player/web/info_json.h"

namespace splatlas {
namespace {

/// The least and the largest coordinates of the voxels, as --cut and --center take them.
std::pair<Vec3, Vec3> extent_lps_mm(const Grid& grid) {
  const Affine to_lps = index_to_lps_mm(grid);
  Vec3 low, high;
  for (std::size_t a = 0; a < 3; ++a) {
    low[a] = high[a] = to_lps.offset[a];
    for (std::size_t b = 0; b < 3; ++b) {
      const double per_voxel = to_lps.linear[3 * a + b];
      const auto [least, most] =
          std::minmax({-0.5 * per_voxel, (static_cast<double>(grid.size[b]) - 0.5) * per_voxel});
      low[a] += least;
      high[a] += most;
    }
  }
  return {low, high};
}

}  // namespace

PrintableText info_text(const Atlas& atlas) {
  PrintableText text;
  const Grid& grid = atlas.source_grid();
  text.add("{}: atlas {}, {} bytes\n", atlas.name(), atlas.format_version(), atlas.counters().file);
  if (!atlas.provenance().title.empty()) text.add("title     {}\n", atlas.provenance().title);
  text.add("grid      {} x {} x {} voxels of {:g} x {:g} x {:g} mm, values {}\n", grid.size[0], grid.size[1],
           grid.size[2], grid.spacing_mm[0], grid.spacing_mm[1], grid.spacing_mm[2],
           name_of(atlas.value_type()));
  const auto [low, high] = extent_lps_mm(grid);
  text.add("extent    left {:.1f} to {:.1f}, posterior {:.1f} to {:.1f}, superior {:.1f} to {:.1f} mm\n",
           low[0], high[0], low[1], high[1], low[2], high[2]);
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
