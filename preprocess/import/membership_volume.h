// Structure sets per voxel, and grids and volumes within a margin.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "format/content/grid.h"
#include "format/content/structure_graph.h"

namespace splatlas {

/// Voxels added at both ends of each axis of a grid.
struct Margin {
  Index3 low{0, 0, 0}, high{0, 0, 0};

  [[nodiscard]] bool empty() const { return low == Index3{0, 0, 0} && high == Index3{0, 0, 0}; }
};

/// The grid with a margin, and the margin of the axes before they were reordered.
[[nodiscard]] Grid widened(const Grid& grid, const Margin& margin);
[[nodiscard]] Margin before_reordering(const Margin& margin, const AxisOrder& order);

/// Voxels of a grid of `size`, within a margin of `fill`.
template <typename T>
[[nodiscard]] std::vector<T> widened(std::span<const T> voxels, const Index3& size, const Margin& margin,
                                     T fill) {
  Index3 all;
  for (std::size_t a = 0; a < 3; ++a) all[a] = size[a] + margin.low[a] + margin.high[a];
  std::vector<T> result(static_cast<std::size_t>(all[0] * all[1] * all[2]), fill);
  for (std::int64_t k = 0; k < size[2]; ++k) {
    for (std::int64_t j = 0; j < size[1]; ++j) {
      const auto from = voxels.subspan(static_cast<std::size_t>((k * size[1] + j) * size[0]),
                                       static_cast<std::size_t>(size[0]));
      std::ranges::copy(
          from, result.begin() + ((k + margin.low[2]) * all[1] + j + margin.low[1]) * all[0] + margin.low[0]);
    }
  }
  return result;
}

/// The set of structures that contain each voxel. There are few distinct sets, so that voxels store set ids.
/// Label maps have sets of at most one structure.
class MembershipVolume {
 public:
  using SetId = std::uint32_t;  ///< 0 is the empty set

  /// All sets are empty.
  explicit MembershipVolume(const Index3& size);
  /// `sets[n]` is set n, sorted and unique. All sets must differ, and sets[0] must be empty.
  MembershipVolume(const Index3& size, std::vector<std::vector<StructureIndex>> sets,
                   std::vector<SetId> voxels);

  [[nodiscard]] const Index3& size() const { return size_; }
  [[nodiscard]] std::span<const SetId> voxels() const { return voxels_; }  ///< i fastest
  [[nodiscard]] std::span<const std::vector<StructureIndex>> sets() const { return sets_; }
  /// True if no voxel is in two structures.
  [[nodiscard]] bool disjoint() const;
  /// Takes the sets of the voxels away.
  [[nodiscard]] std::vector<SetId> take_voxels() { return std::move(voxels_); }

  /// Adds `structure` to the sets of all voxels with non-zero `mask`. Returns their number. Cost: one pass.
  std::uint64_t add(StructureIndex structure, std::span<const std::uint8_t> mask);
  /// Gives every voxel the sorted set combined(its set, its key). Cost: one pass, a call per set and key.
  template <typename Key, typename Combined>
  void combine(std::span<const Key> keys, const Combined& combined) {
    std::map<std::pair<SetId, Key>, SetId> known;
    auto last = known.end();
    for (std::size_t v = 0; v < voxels_.size(); ++v) {
      if (const std::pair pair{voxels_[v], keys[v]}; last == known.end() || last->first != pair) {
        last = known.try_emplace(pair, 0).first;
        if (last->second == 0) last->second = intern(combined(sets_[pair.first], pair.second));
      }
      voxels_[v] = last->second;
    }
  }
  /// Adds empty voxels around.
  void widen(const Margin& margin);
  /// Removes `structure` from the set of a voxel.
  void remove(StructureIndex structure, std::size_t voxel);
  /// Sets the set of a voxel to that of another one.
  void set(std::size_t voxel, SetId of_another) { voxels_[voxel] = of_another; }
  /// Replaces structure n by `new_numbers[n]`. Cost: linear in the sets.
  void renumber(std::span<const StructureIndex> new_numbers);

 private:
  SetId intern(std::vector<StructureIndex> set);

  Index3 size_;
  std::vector<std::vector<StructureIndex>> sets_;
  std::vector<SetId> voxels_;
  std::map<std::vector<StructureIndex>, SetId> index_;
};

}  // namespace splatlas
