#include "tests/scenes/expected_counts.h"

#include <vector>

namespace splatlas {
namespace {

struct Drawn {
  bool volume = false, surface = false;
};

/// The rules of VoxelRole, restated.
Drawn drawn(const ClassTable& classes, ClassId c, const Selection& selection) {
  Drawn sum;
  for (const Membership& member : classes.members(c)) {
    const DrawMode mode = selection.structures[member.structure].mode;
    if (mode == DrawMode::kOff) continue;
    const bool fills = mode == DrawMode::kVolume || mode == DrawMode::kBoth;
    switch (member.part) {
      case Part::kInterior: sum.volume |= fills; break;
      case Part::kBoundary:
        sum.volume |= fills;
        sum.surface |= mode != DrawMode::kVolume;
        break;
      case Part::kCrossed: sum.surface = true; break;
    }
  }
  return sum;
}

}  // namespace

ExpectedCounts expected_counts(const AtlasContent& content, const Selection& selection, Axis principal) {
  ExpectedCounts counts;
  const Grid grid = storage_grid(content);
  const ScanOrder order = ScanOrder::of(principal);
  std::vector<Drawn> of_class;
  for (ClassId c = 0; c < content.classes.size(); ++c)
    of_class.push_back(drawn(content.classes, c, selection));

  Index3 at{};
  std::int64_t& scan = at[order.scan_axis];
  for (at[order.slice_axis] = 0; at[order.slice_axis] < grid.size[order.slice_axis]; ++at[order.slice_axis]) {
    for (at[order.row_axis] = 0; at[order.row_axis] < grid.size[order.row_axis]; ++at[order.row_axis]) {
      ClassId before = kEmptyClass;
      for (scan = 0; scan < grid.size[order.scan_axis]; ++scan) {
        const ClassId c = content.class_volume[static_cast<std::size_t>(grid.offset(at[0], at[1], at[2]))];
        const Drawn& role = of_class[c];
        counts.volume += role.volume && !role.surface ? 1 : 0;
        counts.surface += role.surface && !role.volume ? 1 : 0;
        counts.hybrid += role.surface && role.volume ? 1 : 0;
        counts.runs += role.volume && c != before ? 1 : 0;
        before = c;
      }
    }
  }
  for (StructureIndex s = 0; s < content.graph.size(); ++s) {
    const DrawMode mode = selection.structures[s].mode;
    const bool shown = content.graph[s].external ? mode != DrawMode::kOff
                                                 : mode == DrawMode::kSurface || mode == DrawMode::kBoth;
    if (shown) counts.triangles += content.surfaces[s].triangles.size();
  }
  return counts;
}

}  // namespace splatlas
