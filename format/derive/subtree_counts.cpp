#include "format/derive/subtree_counts.h"

#include <algorithm>
#include <bit>

namespace splatlas {
namespace {

constexpr std::size_t kBatch = 64;
using Mask = std::uint64_t;  // bit n: the n-th structure of the batch

/// Calls add(n) for the structures of a mask.
template <typename Add>
void for_each_bit(Mask mask, const Add& add) {
  for (; mask != 0; mask &= mask - 1) add(static_cast<std::size_t>(std::countr_zero(mask)));
}

/// Counts of up to 64 structures by one traversal of their descendants.
class BatchCounter {
 public:
  BatchCounter(const StructureGraph& graph, const ClassTable& classes, const DecisionTree& tree,
               std::span<const std::uint64_t> triangles)
      : graph_(graph),
        classes_(classes),
        tree_(tree),
        triangles_(triangles),
        rank_(graph.size()),
        above_(graph.size(), 0),
        inside_(classes.size(), 0),
        on_boundary_(classes.size(), 0) {
    const auto order = graph.topological();
    for (std::uint32_t n = 0; n < order.size(); ++n) rank_[order[n]] = n;
  }

  void count(std::span<const StructureIndex> batch, std::vector<SubtreeCounts>& counts) {
    const std::vector<StructureIndex> below = descend(batch);
    for (const StructureIndex s : below) {
      for_each_bit(above_[s], [&](std::size_t n) { counts[batch[n]].triangles += triangles_[s]; });
      for (const ClassId c : tree_.interior_classes(s)) mark(inside_, c, s);
      for (const ClassId c : tree_.boundary_classes(s)) mark(on_boundary_, c, s);
      above_[s] = 0;
    }
    for (const ClassId c : touched_) {
      const std::uint64_t voxels = classes_.voxels(c);
      for_each_bit(on_boundary_[c], [&](std::size_t n) { counts[batch[n]].boundary += voxels; });
      for_each_bit(inside_[c] & ~on_boundary_[c],
                   [&](std::size_t n) { counts[batch[n]].interior += voxels; });
      inside_[c] = on_boundary_[c] = 0;
    }
    touched_.clear();
  }

 private:
  void mark(std::vector<Mask>& masks, ClassId c, StructureIndex s) {
    if ((inside_[c] | on_boundary_[c]) == 0) touched_.push_back(c);
    masks[c] |= above_[s];
  }

  /// Sets above_ of all descendants, and returns them in topological order.
  std::vector<StructureIndex> descend(std::span<const StructureIndex> batch) {
    std::vector<StructureIndex> below = graph_.descendants(batch);
    std::ranges::sort(below, {}, [&](StructureIndex s) { return rank_[s]; });
    for (std::size_t n = 0; n < batch.size(); ++n) above_[batch[n]] |= Mask{1} << n;
    for (const StructureIndex s : below) {
      for (const StructureIndex child : graph_.children(s)) above_[child] |= above_[s];
    }
    return below;
  }

  const StructureGraph& graph_;
  const ClassTable& classes_;
  const DecisionTree& tree_;
  std::span<const std::uint64_t> triangles_;
  std::vector<std::uint32_t> rank_;         // [structure]: in topological order
  std::vector<Mask> above_;                 // [structure]: structures of the batch that contain it
  std::vector<Mask> inside_, on_boundary_;  // [class]
  std::vector<ClassId> touched_;
};

}  // namespace

std::vector<SubtreeCounts> subtree_counts(const StructureGraph& graph, const ClassTable& classes,
                                          const DecisionTree& tree,
                                          std::span<const std::uint64_t> triangles) {
  std::vector<SubtreeCounts> counts(graph.size());
  BatchCounter counter(graph, classes, tree, triangles);
  const auto order = graph.preorder();  // neighbours share most descendants
  for (std::size_t first = 0; first < order.size(); first += kBatch)
    counter.count(order.subspan(first, std::min(kBatch, order.size() - first)), counts);
  return counts;
}

}  // namespace splatlas
