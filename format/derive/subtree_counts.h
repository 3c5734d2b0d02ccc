// Voxels and triangles below every structure.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "format/content/class_table.h"
#include "format/content/decision_tree.h"
#include "format/content/structure_graph.h"

namespace splatlas {

/// Counts of a structure and its descendants, each descendant and each class counted once. A class counts as
/// boundary if it is on the boundary of any of them or crossed by their surface, else as interior.
struct SubtreeCounts {
  std::uint64_t interior = 0, boundary = 0;  ///< voxels
  std::uint64_t triangles = 0;
  friend bool operator==(const SubtreeCounts&, const SubtreeCounts&) = default;
};

/// [structure]: its counts, for all structures at once. `tree` is that of graph and classes; `triangles` has
/// one entry per structure. Sixty-four structures share one traversal of their descendants. Cost in a graph
/// of s structures and e parents: at most s / 64 * (s + e), and one step per pair of a structure and a class
/// or structure below it.
[[nodiscard]] std::vector<SubtreeCounts> subtree_counts(const StructureGraph& graph,
                                                        const ClassTable& classes, const DecisionTree& tree,
                                                        std::span<const std::uint64_t> triangles);

}  // namespace splatlas
