// An octree over the classes of the voxels: what the run model is compared with (paper, section 5).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "bench/run_collector.h"
#include "format/class_table.h"

namespace splatlas {

/// A cube of voxels whose side is a power of two, halved along every axis until one class fills a node, or
/// until it is a brick. Every node knows the set of the classes in it, so a walk enters only nodes that hold
/// something selected, and passes over nothing else; one tree serves the three principal axes. Immutable.
class ClassOctree {
 public:
  /// `volume` has `size` voxels, i fastest. Nodes of `leaf_side` voxels a side (a power of two) keep the
  /// class of every voxel where they are not of one class; 1 halves down to single voxels. Cost: linear in
  /// the voxels, times the logarithm of the sets of classes that occur.
  ClassOctree(std::span<const ClassId> volume, const Index3& size, std::int64_t leaf_side);

  /// Adds the runs of every class with a draw; nodes in which all is drawn alike are not entered. Within a
  /// scanline the runs come in order. `draw_of_class` is one of draws_by_class(). Cost: nodes that hold
  /// something selected, and the rows of those that are filled.
  void collect(std::span<const std::uint32_t> draw_of_class, RunCollector& runs) const;

  [[nodiscard]] std::size_t nodes() const { return nodes_.size() + 1; }
  [[nodiscard]] std::size_t bricks() const { return bricks_.size() / brick_voxels(); }
  /// Memory.
  [[nodiscard]] std::size_t bytes() const;
  /// What a file would have to hold: the set of every node in the order of the walk, bricks, and the sets.
  [[nodiscard]] std::vector<std::byte> encoded() const;

 private:
  struct Node {
    std::uint32_t first = 0;  // of eight children, or number of a brick; nothing in nodes of one class
    std::uint32_t set = 0;    // of classes
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
  std::int64_t side_ = 1;  // of the root, in voxels
  Node root_;
  std::vector<Node> nodes_;       // but for the root; child n has bit a set in the upper half of axis a
  std::vector<ClassId> bricks_;   // i fastest
  std::vector<ClassId> members_;  // of the sets, ascending
  std::vector<std::uint32_t> first_member_;  // per set, and the end
};

}  // namespace splatlas
