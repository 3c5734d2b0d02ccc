// Octree over the classes of voxels, the alternative to the run model (paper, section 5).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "bench/experiments/run_collector.h"
#include "format/content/class_table.h"

namespace splatlas {

/// A cube of voxels with a power of two as side, subdivided until one class fills a node, or down to a brick.
/// Every node stores the set of its classes, so that a traversal enters only nodes with selected voxels. One
/// tree serves all principal axes. Immutable.
class ClassOctree {
 public:
  /// `volume` has `size` voxels, i fastest. Mixed nodes of `leaf_side` voxels a side (a power of two) store
  /// the class of every voxel; 1 subdivides down to voxels. Cost: linear in the voxels, times the logarithm
  /// of the number of distinct sets.
  ClassOctree(std::span<const ClassId> volume, const Index3& size, std::int64_t leaf_side);

  /// Adds the runs of every class with a draw. Does not enter nodes with a single draw. Runs within a
  /// scanline are sorted. `draw_of_class` comes from draws_by_class(). Cost: nodes with selected voxels, and
  /// the rows of filled ones.
  void collect(std::span<const std::uint32_t> draw_of_class, RunCollector& runs) const;

  [[nodiscard]] std::size_t nodes() const { return nodes_.size() + 1; }
  [[nodiscard]] std::size_t bricks() const { return bricks_.size() / brick_voxels(); }
  /// Memory in bytes.
  [[nodiscard]] std::size_t bytes() const;
  /// File representation: the set of every node in traversal order, bricks, and sets.
  [[nodiscard]] std::vector<std::byte> encoded() const;

 private:
  struct Node {
    std::uint32_t first = 0;  // first of eight children, or index of a brick; unused in nodes of one class
    std::uint32_t set = 0;    // set of classes
  };
  class Builder;
  class Walk;

  [[nodiscard]] std::span<const ClassId> classes(std::uint32_t set) const {
    return std::span(members_).subspan(first_member_[set], first_member_[set + 1] - first_member_[set]);
  }
  [[nodiscard]] std::size_t brick_voxels() const {
    return static_cast<std::size_t>(leaf_side_ * leaf_side_ * leaf_side_);
  }

  Index3 size_;
  std::int64_t leaf_side_;
  std::int64_t side_ = 1;  // side of the root, in voxels
  Node root_;
  std::vector<Node> nodes_;       // without the root; bit a of child n selects the upper half of axis a
  std::vector<ClassId> bricks_;   // i fastest
  std::vector<ClassId> members_;  // members of the sets, ascending
  std::vector<std::uint32_t> first_member_;  // per set, and the end
};

}  // namespace splatlas
