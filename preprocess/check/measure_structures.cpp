#include <algorithm>
#include <cmath>
#include <set>

#include "preprocess/check/examine_atlas.h"
#include "preprocess/classify/fragments.h"

namespace splatlas {
namespace {

using SetId = MembershipVolume::SetId;
using Sums = StructureMeasures::Sums;
constexpr SetId kOutside = 1;  // the set of voxels in no structure: of a structure behind all others

MembershipVolume memberships_of(const Atlas& atlas, std::vector<ClassId> volume) {
  std::vector<std::vector<StructureIndex>> sets{{}, {static_cast<StructureIndex>(atlas.graph().size())}};
  std::map<std::vector<StructureIndex>, SetId> set_of{{{}, kOutside}};
  std::vector<SetId> set_of_class;
  for (ClassId c = 0; c < atlas.classes().size(); ++c) {
    std::vector<StructureIndex> set;
    for (const Membership& m : atlas.classes().members(c)) {
      if (m.holds()) set.push_back(m.structure);
    }
    const auto [found, is_new] = set_of.emplace(set, static_cast<SetId>(sets.size()));
    if (is_new) sets.push_back(std::move(set));
    set_of_class.push_back(found->second);
  }
  for (ClassId& voxel : volume) voxel = set_of_class[voxel];
  return {atlas.grid().size, std::move(sets), std::move(volume)};
}

/// The first and last cell of voxel n of an axis; cells are square, in mm.
std::pair<std::size_t, std::size_t> cells_of(std::int64_t n, std::size_t axis, const Grid& grid) {
  const auto length = [&](std::size_t a) { return static_cast<double>(grid.size[a]) * grid.spacing_mm[a]; };
  const double cells = grid.spacing_mm[axis] * kPictureCells / std::max(length(0), length(2));
  const auto last = static_cast<std::size_t>(std::ceil(static_cast<double>(n + 1) * cells) - 1);
  return {std::min(static_cast<std::size_t>(static_cast<double>(n) * cells), kPictureCells - 1),
          std::min(last, kPictureCells - 1)};
}

/// Calls visit(set, offset, count, place) for runs of voxels of one set, with the first voxel of each.
template <typename Visit>
void visit_runs(const MembershipVolume& memberships, const Visit& visit) {
  const auto width = static_cast<std::size_t>(memberships.size()[0]);
  for (std::size_t first = 0; first < memberships.voxels().size(); first += width) {
    const auto row = memberships.voxels().subspan(first, width);
    const auto scanline = static_cast<std::int64_t>(first / width);
    for (std::size_t n = 0, end = 0; n < width; n = end) {
      for (end = n; end < width && row[end] == row[n];) ++end;
      visit(row[n], first + n, end - n,
            Index3{static_cast<std::int64_t>(n), scanline % memberships.size()[1],
                   scanline / memberships.size()[1]});
    }
  }
}

std::vector<Sums> sums_of_sets(const MembershipVolume& memberships, const Grid& grid) {
  std::vector<Sums> sums(memberships.sets().size());
  visit_runs(memberships, [&](SetId set, std::size_t, std::size_t count, const Index3& at) {
    const Index3 last{at[0] + static_cast<std::int64_t>(count) - 1, at[1], at[2]};
    Sums run{count, {}, {at, last}, {}};
    for (std::size_t a = 0; a < 3; ++a)
      run.index[a] = static_cast<double>(count) * static_cast<double>(at[a] + last[a]) / 2;
    const std::size_t left = cells_of(at[0], 0, grid).first, right = cells_of(last[0], 0, grid).second;
    const auto [top, bottom] = cells_of(grid.size[2] - 1 - at[2], 2, grid);
    for (std::size_t row = top; row <= bottom; ++row)
      run.shape[row] = ~std::uint64_t{0} >> (kPictureCells - 1 - (right - left)) << left;
    sums[set].add(run);
  });
  return sums;
}

void add_part(SmallParts& parts, const StructureComponent& part) {
  ++parts.count;
  if (part.voxels <= parts.largest) return;
  parts.largest = part.voxels;
  parts.voxel = part.first;
}

/// Counts pieces, and the holes that one structure encloses.
void measure_parts(const MembershipVolume& memberships, std::vector<StructureMeasures>& structures) {
  constexpr std::uint64_t kSmall = 100, kShare = 20;  // voxels; of the largest piece
  std::vector<const StructureComponent*> largest(structures.size() + 1);
  const std::vector<StructureComponent> components = list_components(memberships, structures.size() + 1);
  for (const StructureComponent& component : components) {
    const StructureComponent*& most = largest[component.structure];
    if (most == nullptr || component.voxels > most->voxels) most = &component;
  }
  std::vector<bool> is_visited(memberships.voxels().size());
  for (const StructureComponent& component : components) {
    if (component.structure < structures.size()) {
      StructureMeasures& structure = structures[component.structure];
      ++structure.pieces;
      const StructureComponent* most = largest[component.structure];
      if (&component != most && component.voxels < kSmall && component.voxels * kShare < most->voxels)
        add_part(structure.stray_pieces, component);
      continue;
    }
    std::set<SetId> around;
    flood_voxels(memberships.size(), component.first, [&](std::size_t voxel) {
      const SetId set = voxel == kBeyondGrid ? 0 : memberships.voxels()[voxel];
      const bool is_new = set == kOutside && !is_visited[voxel];
      if (is_new) is_visited[voxel] = true;
      if (set != kOutside) around.insert(set);
      return is_new && !around.contains(0);
    });
    std::vector<StructureIndex> enclosing = memberships.sets()[*around.begin()];
    for (const SetId set : around) {
      std::erase_if(enclosing,
                    [&](StructureIndex s) { return std::ranges::count(memberships.sets()[set], s) == 0; });
    }
    for (const StructureIndex s : enclosing) {
      ++structures[s].holes;
      if (component.voxels < kSmall) add_part(structures[s].small_holes, component);
    }
  }
}

void find_pairs(const Atlas& atlas, const MembershipVolume& memberships, AtlasMeasures& measures) {
  const auto voxels = memberships.voxels();
  std::map<std::pair<SetId, SetId>, std::size_t> touching;
  const auto step_j = static_cast<std::size_t>(memberships.size()[0]);
  const auto step_k = step_j * static_cast<std::size_t>(memberships.size()[1]);
  visit_runs(memberships, [&](SetId set, std::size_t first, std::size_t count, const Index3& at) {
    if (set == kOutside) return;
    const auto touch = [&](std::size_t voxel, std::size_t other) {
      if (voxels[other] != set && voxels[other] != kOutside)
        touching.try_emplace({set, voxels[other]}, voxel);
    };
    if (at[0] > 0) touch(first, first - 1);
    for (std::size_t v = first; v < first + count && at[1] > 0; ++v) touch(v, v - step_j);
    for (std::size_t v = first; v < first + count && at[2] > 0; ++v) touch(v, v - step_k);
    const auto& members = memberships.sets()[set];
    for (std::size_t b = 1; b < members.size(); ++b) {
      for (std::size_t a = 0; a < b; ++a)
        measures.shared.try_emplace({members[a], members[b]}, 0, first).first->second.first += count;
    }
  });
  for (const auto& [sets, voxel] : touching) {
    for (const StructureIndex a : memberships.sets()[sets.first]) {
      for (const StructureIndex b : memberships.sets()[sets.second]) {
        if (a != b && atlas.graph()[a].color == atlas.graph()[b].color)
          measures.touching.try_emplace(std::minmax(a, b), 1, voxel);
      }
    }
  }
}

void find_apart(const Atlas& atlas, const MembershipVolume& memberships, AtlasMeasures& measures) {
  std::map<StructureIndex, IndexBox> boxes;
  for (ClassId c = 0; c < atlas.classes().size(); ++c) {
    for (const Membership& m : atlas.classes().members(c)) {
      if (!m.holds()) boxes[m.structure].include(atlas.classes().box(c));
    }
  }
  visit_runs(memberships, [&](SetId set, std::size_t, std::size_t count, const Index3& at) {
    const IndexBox run{at, {at[0] + static_cast<std::int64_t>(count) - 1, at[1], at[2]}};
    if (set != kOutside)
      std::erase_if(boxes, [&](const auto& surface) { return overlap(surface.second, run); });
  });
  for (const auto& [structure, box] : boxes) {
    for (std::size_t a = 0; a < 3; ++a) measures.apart[structure][a] = (box.first[a] + box.last[a]) / 2;
  }
}

}  // namespace

void StructureMeasures::Sums::add(const Sums& other) {
  voxels += other.voxels;
  for (std::size_t a = 0; a < 3; ++a) index[a] += other.index[a];
  box.include(other.box);
  for (std::size_t row = 0; row < kPictureCells; ++row) shape[row] |= other.shape[row];
}

std::array<std::size_t, 2> cell_of(const Index3& voxel, const Grid& grid) {
  return {cells_of(voxel[0], 0, grid).first, cells_of(grid.size[2] - 1 - voxel[2], 2, grid).first};
}

AtlasMeasures measure_structures(const Atlas& atlas, std::vector<ClassId> class_volume) {
  const MembershipVolume memberships = memberships_of(atlas, std::move(class_volume));
  const StructureGraph& graph = atlas.graph();
  AtlasMeasures measures{std::vector<StructureMeasures>(graph.size()), {}, {}, {}, {}};
  const std::vector<Sums> sums = sums_of_sets(memberships, atlas.grid());
  std::vector<std::vector<SetId>> sets_of(graph.size());
  for (SetId set = kOutside + 1; set < sums.size(); ++set) {
    measures.all.add(sums[set]);
    for (const StructureIndex s : memberships.sets()[set]) sets_of[s].push_back(set);
  }
  for (StructureIndex s = 0; s < graph.size(); ++s) {
    std::set<SetId> sets;
    for (const StructureIndex below : graph.descendants(s))
      sets.insert(sets_of[below].begin(), sets_of[below].end());
    for (const SetId set : sets) measures.structures[s].sums.add(sums[set]);
  }
  measure_parts(memberships, measures.structures);
  find_pairs(atlas, memberships, measures);
  if (measures.all.voxels > 0) find_apart(atlas, memberships, measures);
  return measures;
}

}  // namespace splatlas
