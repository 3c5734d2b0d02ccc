#include "player/page/named_structures.h"

#include <algorithm>
#include <map>

#include "format/text/ascii_text.h"

namespace splatlas {
namespace {

constexpr int kMaxPicks = 40000;
/// Longer texts would take the whole page, and seconds to lay out. Names of built atlases are never longer.
constexpr std::size_t kMaxTextBytes = 4000, kMaxNameBytes = 800;

std::string printed_name(const Structure& structure) {
  std::string name = structure.name.empty() ? structure.id : structure.name;
  std::replace(name.begin(), name.end(), '_', ' ');
  return printable(shortened(name, kMaxNameBytes));
}

}  // namespace

std::string printed_line(std::string_view text) {
  return printable(shortened(text, kMaxTextBytes));
}

std::string printed_lines(std::string_view text) {
  std::string lines = printable_lines(shortened(text, kMaxTextBytes));
  std::replace(lines.begin(), lines.end(), '\t', ' ');
  return lines;
}

std::vector<NamedStructure> named_structures(const Picture& picture, const StructureAt& at,
                                             const StructureGraph& graph, const Selection& selection,
                                             const std::vector<bool>& labelled) {
  std::map<StructureIndex, VisibleStructure> visible;
  for (const VisibleStructure& one : visible_structures(sample_structures(picture, at, kMaxPicks)))
    visible.emplace(one.structure, one);
  std::vector<NamedStructure> structures;
  for (const StructureIndex s : graph.preorder()) {
    const auto found = visible.find(s);
    if (found == visible.end()) continue;
    structures.push_back({printed_name(graph[s]), selection.structures[s].color, found->second,
                          labelled.empty() || labelled[s]});
  }
  return structures;
}

}  // namespace splatlas
