#include "preprocess/classify/fragments.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <utility>

namespace splatlas {
namespace {

/// Disjoint sets of connected voxels (Tarjan 1975), with their counts.
class ComponentForest {
 public:
  struct Node {
    std::size_t parent = 0;
    std::uint64_t voxels = 0;  ///< of the component, at its root
    StructureIndex structure = kNoStructure;
    std::size_t first = 0;  ///< voxel
  };

  [[nodiscard]] std::size_t add(StructureIndex structure, std::size_t voxel) {
    nodes_.push_back({nodes_.size(), 0, structure, voxel});
    return nodes_.size() - 1;
  }
  [[nodiscard]] std::size_t root_of(std::size_t node) {
    while (nodes_[node].parent != node) {
      nodes_[node].parent = nodes_[nodes_[node].parent].parent;
      node = nodes_[node].parent;
    }
    return node;
  }
  /// Roots are the first nodes of their components.
  [[nodiscard]] std::size_t join(std::size_t a, std::size_t b) {
    if (a == b || (a = root_of(a)) == (b = root_of(b))) return a;
    const auto [low, high] = std::minmax(a, b);
    nodes_[high].parent = low;
    nodes_[low].voxels += nodes_[high].voxels;
    return low;
  }
  void count(std::size_t node) { ++nodes_[root_of(node)].voxels; }
  [[nodiscard]] const std::vector<Node>& nodes() const { return nodes_; }

 private:
  std::vector<Node> nodes_;
};

/// Numbers the components of all structures with a limit `below`, voxel by voxel. Calls
/// new_component(structure, voxel), which returns a number, join(a, b) of numbers that touch, which returns
/// one of them, and visit(structure, number, voxel). Two scans of one volume number the components alike.
template <typename NewComponent, typename Join, typename Visit>
void scan_components(const MembershipVolume& memberships, std::span<const std::uint64_t> below,
                     const NewComponent& new_component, const Join& join, const Visit& visit) {
  std::vector<std::vector<StructureIndex>> sets;  // of the structures that are examined
  for (const auto& set : memberships.sets()) {
    std::ranges::copy_if(set, std::back_inserter(sets.emplace_back()), [&](StructureIndex structure) {
      return structure < below.size() && below[structure] > 0;
    });
  }
  constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  const auto voxels = memberships.voxels();
  const auto row = static_cast<std::size_t>(memberships.size()[0]);
  const std::size_t plane = row * static_cast<std::size_t>(memberships.size()[1]);
  // By voxel of a slice and of the one before: where its numbers begin, one a structure
  std::vector<std::size_t> firsts(plane), numbers, firsts_before(plane), numbers_before;
  for (std::size_t start = 0; start < voxels.size(); start += plane) {
    firsts.swap(firsts_before);
    numbers.swap(numbers_before);
    numbers.clear();
    std::size_t column = 0;
    for (std::size_t v = 0; v < plane; ++v, column = column + 1 == row ? 0 : column + 1) {
      firsts[v] = numbers.size();
      for (const StructureIndex structure : sets[voxels[start + v]]) {
        std::size_t number = kNone;
        const auto touch = [&](MembershipVolume::SetId set, const std::size_t* other) {
          const auto same = std::ranges::find(sets[set], structure);
          if (same == sets[set].end()) return;
          other += same - sets[set].begin();
          number = number == kNone ? *other : join(number, *other);
        };
        if (column > 0) touch(voxels[start + v - 1], numbers.data() + firsts[v - 1]);
        if (v >= row) touch(voxels[start + v - row], numbers.data() + firsts[v - row]);
        if (start > 0) touch(voxels[start + v - plane], numbers_before.data() + firsts_before[v]);
        if (number == kNone) number = new_component(structure, start + v);
        numbers.push_back(number);
        visit(structure, number, start + v);
      }
    }
  }
}

ComponentForest components_of(const MembershipVolume& memberships, std::span<const std::uint64_t> below) {
  ComponentForest forest;
  scan_components(
      memberships, below,
      [&](StructureIndex structure, std::size_t voxel) { return forest.add(structure, voxel); },
      [&](std::size_t a, std::size_t b) { return forest.join(a, b); },
      [&](StructureIndex, std::size_t number, std::size_t) { forest.count(number); });
  return forest;
}

/// [node]: whether it is the root of a fragment.
std::vector<bool> fragments_of(const ComponentForest& forest, std::span<const std::uint64_t> below) {
  constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  const auto& nodes = forest.nodes();
  std::vector<std::size_t> largest(below.size(), kNone);
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    std::size_t& best = largest[nodes[n].structure];
    if (nodes[n].parent == n && (best == kNone || nodes[n].voxels > nodes[best].voxels)) best = n;
  }
  std::vector<bool> fragments(nodes.size());
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    const StructureIndex structure = nodes[n].structure;
    fragments[n] = nodes[n].parent == n && n != largest[structure] && nodes[n].voxels < below[structure];
  }
  return fragments;
}

std::vector<StructureFragments> count_fragments(const ComponentForest& forest,
                                                const std::vector<bool>& fragments, std::size_t structures) {
  std::vector<StructureFragments> counts(structures);
  for (std::size_t n = 0; n < fragments.size(); ++n) {
    if (!fragments[n]) continue;
    StructureFragments& count = counts[forest.nodes()[n].structure];
    count.structure = forest.nodes()[n].structure;
    ++count.components;
    count.voxels += forest.nodes()[n].voxels;
  }
  std::erase_if(counts, [](const StructureFragments& count) { return count.components == 0; });
  return counts;
}

/// Gives connected voxels of these to the structures around them, unless they touch other empty voxels or the
/// end of the grid. Clears `voxels`.
void fill_holes(std::vector<bool>& voxels, MembershipVolume& memberships) {
  constexpr MembershipVolume::SetId kEmpty = 0, kHole = 0xffffffff;
  std::vector<std::size_t> hole;
  const auto take = [&](std::size_t voxel) {
    voxels[voxel] = false;
    memberships.set(voxel, kHole);
    hole.push_back(voxel);
  };
  for (std::size_t seed = 0; seed < voxels.size(); ++seed) {
    if (!voxels[seed]) continue;
    std::map<MembershipVolume::SetId, std::size_t> around;
    hole.clear();
    take(seed);
    flood_voxels(memberships.size(), seed, [&](std::size_t beside) {
      const bool is_inside = beside != kBeyondGrid, is_hole = is_inside && voxels[beside];
      if (is_hole) take(beside);
      const MembershipVolume::SetId set = is_inside ? memberships.voxels()[beside] : kEmpty;
      if (set != kHole) ++around[set];
      return is_hole;
    });
    const auto most = std::ranges::max_element(around, {}, [](const auto& of) { return of.second; });
    for (const std::size_t voxel : hole)
      memberships.set(voxel, around.contains(kEmpty) ? kEmpty : most->first);
  }
}

}  // namespace

std::vector<StructureComponent> list_components(const MembershipVolume& memberships, std::size_t structures) {
  const ComponentForest forest = components_of(memberships, std::vector<std::uint64_t>(structures, 1));
  std::vector<StructureComponent> components;
  for (std::size_t n = 0; n < forest.nodes().size(); ++n) {
    const ComponentForest::Node& node = forest.nodes()[n];
    if (node.parent == n) components.push_back({node.structure, node.voxels, node.first});
  }
  return components;
}

std::vector<StructureFragments> find_fragments(const MembershipVolume& memberships,
                                               std::span<const std::uint64_t> below) {
  const ComponentForest forest = components_of(memberships, below);
  return count_fragments(forest, fragments_of(forest, below), below.size());
}

std::vector<StructureFragments> drop_fragments(MembershipVolume& memberships,
                                               std::span<const std::uint64_t> below) {
  ComponentForest forest = components_of(memberships, below);
  const std::vector<bool> fragments = fragments_of(forest, below);
  std::vector<StructureFragments> counts = count_fragments(forest, fragments, below.size());
  if (counts.empty()) return counts;
  std::size_t next = 0;
  std::vector<std::pair<StructureIndex, std::size_t>> dropped;  // the scan reads sets as they were
  scan_components(
      memberships, below, [&](StructureIndex, std::size_t) { return next++; },
      [](std::size_t a, std::size_t) { return a; },
      [&](StructureIndex structure, std::size_t number, std::size_t voxel) {
        if (fragments[forest.root_of(number)]) dropped.emplace_back(structure, voxel);
      });
  std::vector<bool> emptied(memberships.voxels().size());
  for (const auto& [structure, voxel] : dropped) {
    memberships.remove(structure, voxel);
    emptied[voxel] = memberships.voxels()[voxel] == 0;
  }
  fill_holes(emptied, memberships);
  return counts;
}

}  // namespace splatlas
