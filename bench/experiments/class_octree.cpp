#include "bench/experiments/class_octree.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <map>
#include <utility>

namespace splatlas {
namespace {

using ClassSet = std::vector<ClassId>;  // ascending and unique

void make_set(ClassSet& classes) {
  std::sort(classes.begin(), classes.end());
  classes.erase(std::unique(classes.begin(), classes.end()), classes.end());
}

Index3 corner_of(const Index3& corner, std::int64_t half, unsigned child) {
  return {corner[0] + (child & 1u ? half : 0), corner[1] + (child & 2u ? half : 0),
          corner[2] + (child & 4u ? half : 0)};
}

/// Appends the bytes of numbers.
template <typename T>
void append(const std::vector<T>& numbers, std::vector<std::byte>& bytes) {
  const auto from = std::as_bytes(std::span(numbers));
  bytes.insert(bytes.end(), from.begin(), from.end());
}

}  // namespace

class ClassOctree::Builder {
 public:
  Builder(ClassOctree& tree, std::span<const ClassId> volume) : tree_(tree), volume_(volume) {}

  void build() {
    tree_.side_ = tree_.leaf_side_;
    while (tree_.side_ < std::max({tree_.size_[0], tree_.size_[1], tree_.size_[2]})) tree_.side_ *= 2;
    tree_.root_ = build({0, 0, 0}, tree_.side_);
    tree_.first_member_.assign(1, 0);
    std::vector<const ClassSet*> sets(numbers_.size());
    for (const auto& [set, number] : numbers_) sets[number] = &set;
    for (const ClassSet* set : sets) {
      tree_.members_.insert(tree_.members_.end(), set->begin(), set->end());
      tree_.first_member_.push_back(static_cast<std::uint32_t>(tree_.members_.size()));
    }
  }

 private:
  /// Outside the grid, voxels are empty.
  Node build(const Index3& corner, std::int64_t side) {
    const Index3& size = tree_.size_;
    if (corner[0] >= size[0] || corner[1] >= size[1] || corner[2] >= size[2])
      return {0, number({kEmptyClass})};
    if (side == tree_.leaf_side_) return build_leaf(corner);
    std::array<Node, 8> children;
    ClassSet classes;
    for (unsigned child = 0; child < 8; ++child) {
      children[child] = build(corner_of(corner, side / 2, child), side / 2);
      const ClassSet& set = *sets_[children[child].set];
      classes.insert(classes.end(), set.begin(), set.end());
    }
    make_set(classes);
    const bool filled = classes.size() == 1;
    Node node{0, number(std::move(classes))};
    if (filled) return node;
    node.first = static_cast<std::uint32_t>(tree_.nodes_.size());
    tree_.nodes_.insert(tree_.nodes_.end(), children.begin(), children.end());
    return node;
  }

  Node build_leaf(const Index3& corner) {
    brick_.clear();
    const std::int64_t side = tree_.leaf_side_;
    for (std::int64_t k = corner[2]; k < corner[2] + side; ++k) {
      for (std::int64_t j = corner[1]; j < corner[1] + side; ++j) {
        for (std::int64_t i = corner[0]; i < corner[0] + side; ++i) brick_.push_back(class_at(i, j, k));
      }
    }
    ClassSet classes = brick_;
    make_set(classes);
    const bool filled = classes.size() == 1;
    Node node{0, number(std::move(classes))};
    if (filled) return node;
    node.first = static_cast<std::uint32_t>(tree_.bricks());
    tree_.bricks_.insert(tree_.bricks_.end(), brick_.begin(), brick_.end());
    return node;
  }

  [[nodiscard]] ClassId class_at(std::int64_t i, std::int64_t j, std::int64_t k) const {
    const Index3& size = tree_.size_;
    if (i >= size[0] || j >= size[1] || k >= size[2]) return kEmptyClass;
    return volume_[static_cast<std::size_t>((k * size[1] + j) * size[0] + i)];
  }

  std::uint32_t number(ClassSet set) {
    const auto [entry, is_new] =
        numbers_.try_emplace(std::move(set), static_cast<std::uint32_t>(numbers_.size()));
    if (is_new) sets_.push_back(&entry->first);
    return entry->second;
  }

  ClassOctree& tree_;
  std::span<const ClassId> volume_;
  std::map<ClassSet, std::uint32_t> numbers_;
  std::vector<const ClassSet*> sets_;  // by index
  ClassSet brick_;
};

/// Traversal for one selection.
class ClassOctree::Walk {
 public:
  Walk(const ClassOctree& tree, std::span<const std::uint32_t> draw_of_class, RunCollector& runs)
      : tree_(tree),
        draws_(draw_of_class),
        runs_(runs),
        scan_(runs.scan()),
        draw_of_set_(tree.first_member_.size() - 1, kUnknown) {}

  void visit(const Node& node, const Index3& corner, std::int64_t side) {
    const std::uint32_t draw = draw_of(node.set);
    if (draw == kNotDrawn) return;
    if (draw != kMixed) {
      fill(corner, side, draw);
    } else if (side == tree_.leaf_side_) {
      visit_brick(&tree_.bricks_[node.first * tree_.brick_voxels()], corner);
    } else {
      // Order: slice, row, then position, so that each scanline gets sorted runs.
      for (unsigned n = 0; n < 8; ++n) {
        const unsigned child = (n >> 2u & 1u) << scan_.slice_axis | (n >> 1u & 1u) << scan_.row_axis |
                               (n & 1u) << scan_.scan_axis;
        visit(tree_.nodes_[node.first + child], corner_of(corner, side / 2, child), side / 2);
      }
    }
  }

 private:
  static constexpr std::uint32_t kMixed = kNotDrawn - 1, kUnknown = kNotDrawn - 2;

  /// The common draw of all classes of a set, kNotDrawn if there is none; cached.
  std::uint32_t draw_of(std::uint32_t set) {
    std::uint32_t& known = draw_of_set_[set];
    if (known != kUnknown) return known;
    const auto classes = tree_.classes(set);
    known = draws_[classes[0]];
    for (const ClassId c : classes) {
      if (draws_[c] == known) continue;
      known = kMixed;
      break;
    }
    return known;
  }

  void fill(const Index3& corner, std::int64_t side, std::uint32_t draw) {
    const auto end = [&](std::uint8_t axis) { return std::min(corner[axis] + side, tree_.size_[axis]); };
    const std::int64_t start = corner[scan_.scan_axis];
    const auto length = static_cast<std::uint32_t>(end(scan_.scan_axis) - start);
    for (std::int64_t slice = corner[scan_.slice_axis]; slice < end(scan_.slice_axis); ++slice) {
      for (std::int64_t row = corner[scan_.row_axis]; row < end(scan_.row_axis); ++row) {
        runs_.add(slice, row, static_cast<std::uint32_t>(start), length, draw);
      }
    }
  }

  void visit_brick(const ClassId* classes, const Index3& corner) {
    const std::int64_t side = tree_.leaf_side_;
    const std::array<std::int64_t, 3> step{1, side, side * side};
    for (std::int64_t slice = 0; slice < side; ++slice) {
      for (std::int64_t row = 0; row < side; ++row) {
        const ClassId* const first = classes + slice * step[scan_.slice_axis] + row * step[scan_.row_axis];
        for (std::int64_t n = 0; n < side;) {
          const std::uint32_t draw = draws_[first[n * step[scan_.scan_axis]]];
          const std::int64_t start = n;
          do ++n;
          while (n < side && draws_[first[n * step[scan_.scan_axis]]] == draw);
          if (draw == kNotDrawn) continue;
          runs_.add(corner[scan_.slice_axis] + slice, corner[scan_.row_axis] + row,
                    static_cast<std::uint32_t>(corner[scan_.scan_axis] + start),
                    static_cast<std::uint32_t>(n - start), draw);
        }
      }
    }
  }

  const ClassOctree& tree_;
  std::span<const std::uint32_t> draws_;
  RunCollector& runs_;
  ScanOrder scan_;
  std::vector<std::uint32_t> draw_of_set_;
};

ClassOctree::ClassOctree(std::span<const ClassId> volume, const Index3& size, std::int64_t leaf_side)
    : size_(size), leaf_side_(leaf_side) {
  Builder(*this, volume).build();
}

void ClassOctree::collect(std::span<const std::uint32_t> draw_of_class, RunCollector& runs) const {
  Walk(*this, draw_of_class, runs).visit(root_, {0, 0, 0}, side_);
}

std::size_t ClassOctree::bytes() const {
  return nodes() * sizeof(Node) + sizeof(ClassId) * (bricks_.size() + members_.size()) +
         sizeof(std::uint32_t) * first_member_.size();
}

std::vector<std::byte> ClassOctree::encoded() const {
  std::vector<std::uint32_t> sets{root_.set};
  for (const Node& node : nodes_) sets.push_back(node.set);
  std::vector<std::byte> bytes;
  append(sets, bytes);
  append(bricks_, bytes);
  append(members_, bytes);
  append(first_member_, bytes);
  return bytes;
}

}  // namespace splatlas
