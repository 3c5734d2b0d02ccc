#include "format/content/class_table.h"

#include <algorithm>
#include <numeric>

namespace splatlas {
namespace {

/// Sorts by structure and merges duplicates. Different parts merge to kBoundary: the voxel is inside the
/// structure, and the structure's surface crosses it.
void normalize(std::vector<Membership>& members) {
  std::sort(members.begin(), members.end());
  std::size_t kept = 0;
  for (const Membership& m : members) {
    if (kept > 0 && members[kept - 1].structure == m.structure) {
      if (members[kept - 1].part != m.part) members[kept - 1].part = Part::kBoundary;
    } else {
      members[kept++] = m;
    }
  }
  members.resize(kept);
}

}  // namespace

std::uint64_t IndexBox::voxels() const {
  if (empty()) return 0;
  std::uint64_t voxels = 1;
  for (std::size_t a = 0; a < 3; ++a) voxels *= static_cast<std::uint64_t>(last[a] - first[a] + 1);
  return voxels;
}

bool overlap(const IndexBox& a, const IndexBox& b) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (a.last[axis] < b.first[axis] || a.first[axis] > b.last[axis]) return false;
  }
  return !a.empty() && !b.empty();
}

void IndexBox::include(const IndexBox& other) {
  if (other.empty()) return;
  if (empty()) {
    *this = other;
    return;
  }
  for (std::size_t a = 0; a < 3; ++a) {
    first[a] = std::min(first[a], other.first[a]);
    last[a] = std::max(last[a], other.last[a]);
  }
}

ClassTable::ClassTable() : first_member_{0} {
  intern({});
}

ClassId ClassTable::intern(std::vector<Membership> members) {
  normalize(members);
  const auto [entry, is_new] = index_.try_emplace(std::move(members), static_cast<ClassId>(size()));
  if (is_new) {
    members_.insert(members_.end(), entry->first.begin(), entry->first.end());
    first_member_.push_back(static_cast<std::uint32_t>(members_.size()));
    voxels_.push_back(0);
    boxes_.emplace_back();
  }
  return entry->second;
}

void ClassTable::count(ClassId c, std::uint64_t voxels, const IndexBox& box) {
  voxels_[c] += voxels;
  boxes_[c].include(box);
}

std::span<const Membership> ClassTable::members(ClassId c) const {
  return std::span(members_).subspan(first_member_[c], first_member_[c + 1] - first_member_[c]);
}

ClassTable ClassTable::renumbered(std::span<const ClassId> order) const {
  ClassTable result;
  for (const ClassId old : order) {
    const auto of_class = members(old);
    const ClassId c = result.intern({of_class.begin(), of_class.end()});
    result.count(c, voxels_[old], boxes_[old]);
  }
  return result;
}

std::vector<ClassId> storage_order(const ClassTable& classes, const StructureGraph& graph) {
  std::vector<std::uint32_t> rank(graph.size());
  for (std::uint32_t n = 0; n < rank.size(); ++n) rank[graph.preorder()[n]] = n;

  // Compare whole combinations, so that the order does not depend on the order of intern() calls.
  using Key = std::vector<std::pair<std::uint32_t, Part>>;
  std::vector<Key> keys(classes.size());
  for (ClassId c = 0; c < keys.size(); ++c) {
    for (const Membership& m : classes.members(c)) keys[c].emplace_back(rank[m.structure], m.part);
    std::sort(keys[c].begin(), keys[c].end());
  }
  std::vector<ClassId> order(classes.size());
  std::iota(order.begin(), order.end(), ClassId{0});
  std::sort(order.begin(), order.end(), [&](ClassId a, ClassId b) { return keys[a] < keys[b]; });
  return order;  // class 0 has no members, hence the smallest key
}

}  // namespace splatlas
