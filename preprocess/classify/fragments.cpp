#include "preprocess/classify/fragments.h"

#include <algorithm>
#include <array>
#include <map>
#include <tuple>

namespace splatlas {
namespace {

/// Connected voxels of one structure in a scanline.
struct StructureRun {
  StructureIndex structure = kNoStructure;
  std::int64_t first = 0, last = 0;  ///< i, inclusive
  std::size_t component = 0;         ///< a node of ComponentForest
};
using RunRow = std::vector<StructureRun>;  ///< by structure, then first

/// Disjoint sets of runs (Tarjan 1975), with voxel counts.
class ComponentForest {
 public:
  struct Node {
    std::size_t parent = 0;
    std::uint64_t voxels = 0;  ///< of the component, at its root
    StructureIndex structure = kNoStructure;
  };

  [[nodiscard]] std::size_t add(StructureIndex structure) {
    nodes_.push_back({nodes_.size(), 0, structure});
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
    a = root_of(a);
    b = root_of(b);
    if (a == b) return a;
    const auto [low, high] = std::minmax(a, b);
    nodes_[high].parent = low;
    nodes_[low].voxels += nodes_[high].voxels;
    return low;
  }
  void count(std::size_t node, std::uint64_t voxels) { nodes_[root_of(node)].voxels += voxels; }
  [[nodiscard]] const std::vector<Node>& nodes() const { return nodes_; }

 private:
  std::vector<Node> nodes_;
};

/// The runs of a scanline with the sets `voxels`.
class RowScanner {
 public:
  RowScanner(const MembershipVolume& memberships, std::span<const std::uint64_t> below) {
    for (const auto& set : memberships.sets()) {
      auto& kept = sets_.emplace_back();
      std::ranges::copy_if(set, std::back_inserter(kept), [&](StructureIndex structure) {
        return structure < below.size() && below[structure] > 0;
      });
    }
  }

  void scan(std::span<const MembershipVolume::SetId> voxels, RunRow& row) {
    row.clear();
    open_.clear();
    MembershipVolume::SetId set = 0;
    for (std::size_t i = 0; i < voxels.size(); ++i) {
      if (voxels[i] == set) continue;
      set = voxels[i];
      change(sets_[set], static_cast<std::int64_t>(i), row);
    }
    change({}, static_cast<std::int64_t>(voxels.size()), row);
    std::ranges::sort(row, {}, [](const StructureRun& run) { return std::pair(run.structure, run.first); });
  }

 private:
  /// Ends open runs of structures outside `set`, and begins those of its new ones.
  void change(std::span<const StructureIndex> set, std::int64_t i, RunRow& row) {
    next_.clear();
    auto open = open_.begin();
    const auto end_before = [&](StructureIndex structure) {
      for (; open != open_.end() && open->structure < structure; ++open) {
        open->last = i - 1;
        row.push_back(*open);
      }
    };
    for (const StructureIndex structure : set) {
      end_before(structure);
      const bool continues = open != open_.end() && open->structure == structure;
      next_.push_back(continues ? *open++ : StructureRun{structure, i, i, 0});
    }
    end_before(kNoStructure);
    std::swap(open_, next_);
  }

  std::vector<std::vector<StructureIndex>> sets_;  // [set]: its structures that are examined
  RunRow open_, next_;                             // by structure
};

/// Scans a volume for runs with their components. Two scans of one volume number the components alike.
class ComponentScan {
 public:
  ComponentScan(const MembershipVolume& memberships, std::span<const std::uint64_t> below)
      : memberships_(memberships), scanner_(memberships, below) {}

  /// Calls new_component(structure), which returns a number, join(a, b), which returns one of two numbers,
  /// and visit(run, offset of its first voxel) after them.
  template <typename NewComponent, typename Join, typename Visit>
  void scan(const NewComponent& new_component, const Join& join, const Visit& visit) {
    const auto& [ni, nj, nk] = memberships_.size();
    const auto width = static_cast<std::size_t>(ni);
    std::vector<RunRow> before(static_cast<std::size_t>(nj)), slice(static_cast<std::size_t>(nj));
    constexpr std::size_t kNone = static_cast<std::size_t>(-1);
    std::size_t at = 0;
    for (std::int64_t k = 0; k < nk; ++k) {
      for (std::size_t j = 0; j < slice.size(); ++j, at += width) {
        RunRow& row = slice[j];
        scanner_.scan(memberships_.voxels().subspan(at, width), row);
        for (StructureRun& run : row) run.component = kNone;
        const auto touch = [&](StructureRun& run, const StructureRun& other) {
          run.component = run.component == kNone ? other.component : join(run.component, other.component);
        };
        if (j > 0) for_each_contact(row, slice[j - 1], touch);
        for_each_contact(row, before[j], touch);
        for (StructureRun& run : row) {
          if (run.component == kNone) run.component = new_component(run.structure);
          visit(run, at + static_cast<std::size_t>(run.first));
        }
      }
      std::swap(before, slice);
    }
  }

 private:
  /// Calls visit(a, b) for runs of one structure in two rows that overlap.
  template <typename Visit>
  static void for_each_contact(RunRow& row, const RunRow& other, const Visit& visit) {
    auto b = other.begin();
    for (StructureRun& a : row) {
      while (b != other.end() && std::tie(b->structure, b->last) < std::tie(a.structure, a.first)) ++b;
      for (auto c = b; c != other.end() && c->structure == a.structure && c->first <= a.last; ++c) {
        visit(a, *c);
      }
    }
  }

  const MembershipVolume& memberships_;
  RowScanner scanner_;
};

/// Components of a volume.
ComponentForest components_of(const MembershipVolume& memberships, std::span<const std::uint64_t> below) {
  ComponentForest forest;
  ComponentScan(memberships, below)
      .scan([&](StructureIndex structure) { return forest.add(structure); },
            [&](std::size_t a, std::size_t b) { return forest.join(a, b); },
            [&](const StructureRun& run, std::size_t) {
              forest.count(run.component, static_cast<std::uint64_t>(run.last - run.first + 1));
            });
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
  const Index3& size = memberships.size();
  const std::array<std::int64_t, 3> steps{1, size[0], size[0] * size[1]};
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
    for (std::size_t n = 0; n < hole.size(); ++n) {
      const auto at = static_cast<std::int64_t>(hole[n]);
      for (std::size_t a = 0; a < 3; ++a) {
        for (const std::int64_t side : {-1, 1}) {
          const std::int64_t place = at / steps[a] % size[a] + side;
          const auto beside = static_cast<std::size_t>(at + side * steps[a]);
          const bool is_inside = place >= 0 && place < size[a];
          if (is_inside && voxels[beside]) take(beside);
          const MembershipVolume::SetId set = is_inside ? memberships.voxels()[beside] : kEmpty;
          if (set != kHole) ++around[set];
        }
      }
    }
    const auto most = std::ranges::max_element(around, {}, [](const auto& of) { return of.second; });
    for (const std::size_t voxel : hole)
      memberships.set(voxel, around.contains(kEmpty) ? kEmpty : most->first);
  }
}

}  // namespace

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
  // The scan has read a row before its runs are removed.
  std::size_t next = 0;
  std::vector<bool> emptied(memberships.voxels().size());
  ComponentScan(memberships, below)
      .scan([&](StructureIndex) { return next++; }, [](std::size_t a, std::size_t) { return a; },
            [&](const StructureRun& run, std::size_t first) {
              if (!fragments[forest.root_of(run.component)]) return;
              const auto count = static_cast<std::size_t>(run.last - run.first + 1);
              memberships.remove(run.structure, first, count);
              for (std::size_t v = first; v < first + count; ++v) emptied[v] = memberships.voxels()[v] == 0;
            });
  fill_holes(emptied, memberships);
  return counts;
}

}  // namespace splatlas
