#include "preprocess/import/membership_volume.h"

namespace splatlas {

Grid widened(const Grid& grid, const Margin& margin) {
  Grid wide = grid;
  Vec3 first;
  for (std::size_t a = 0; a < 3; ++a) {
    wide.size[a] += margin.low[a] + margin.high[a];
    first[a] = -static_cast<double>(margin.low[a]);
  }
  wide.origin_lps_mm = index_to_lps_mm(grid).apply(first);
  return wide;
}

Margin before_reordering(const Margin& margin, const AxisOrder& order) {
  Margin source;
  for (std::size_t a = 0; a < 3; ++a) {
    source.low[order.from[a]] = order.flipped[a] ? margin.high[a] : margin.low[a];
    source.high[order.from[a]] = order.flipped[a] ? margin.low[a] : margin.high[a];
  }
  return source;
}

MembershipVolume::MembershipVolume(const Index3& size)
    : MembershipVolume(size, {{}},
                       std::vector<SetId>(static_cast<std::size_t>(size[0] * size[1] * size[2]), 0)) {}

MembershipVolume::MembershipVolume(const Index3& size, std::vector<std::vector<StructureIndex>> sets,
                                   std::vector<SetId> voxels)
    : size_(size), sets_(std::move(sets)), voxels_(std::move(voxels)) {
  for (SetId id = 0; id < sets_.size(); ++id) index_.emplace(sets_[id], id);
}

bool MembershipVolume::disjoint() const {
  return std::all_of(sets_.begin(), sets_.end(), [](const auto& set) { return set.size() <= 1; });
}

std::uint64_t MembershipVolume::add(StructureIndex structure, std::span<const std::uint8_t> mask) {
  constexpr SetId kUnknown = 0xffffffff;
  std::vector<SetId> extended(sets_.size(), kUnknown);  // [set]: its union with `structure`
  std::uint64_t count = 0;
  for (std::size_t v = 0; v < voxels_.size(); ++v) {
    if (mask[v] == 0) continue;
    SetId& with = extended[voxels_[v]];
    if (with == kUnknown) {
      std::vector<StructureIndex> set = sets_[voxels_[v]];
      set.insert(std::lower_bound(set.begin(), set.end(), structure), structure);
      with = intern(std::move(set));
    }
    voxels_[v] = with;
    ++count;
  }
  return count;
}

void MembershipVolume::widen(const Margin& margin) {
  voxels_ = widened<SetId>(voxels_, size_, margin, 0);
  for (std::size_t a = 0; a < 3; ++a) size_[a] += margin.low[a] + margin.high[a];
}

void MembershipVolume::remove(StructureIndex structure, std::size_t voxel) {
  std::vector<StructureIndex> set = sets_[voxels_[voxel]];
  std::erase(set, structure);
  voxels_[voxel] = intern(std::move(set));
}

void MembershipVolume::renumber(std::span<const StructureIndex> new_numbers) {
  index_.clear();
  for (SetId id = 0; id < sets_.size(); ++id) {
    for (StructureIndex& structure : sets_[id]) structure = new_numbers[structure];
    std::sort(sets_[id].begin(), sets_[id].end());
    index_.emplace(sets_[id], id);
  }
}

MembershipVolume::SetId MembershipVolume::intern(std::vector<StructureIndex> set) {
  const auto [entry, is_new] = index_.try_emplace(std::move(set), static_cast<SetId>(sets_.size()));
  if (is_new) sets_.push_back(entry->first);
  return entry->second;
}

}  // namespace splatlas
