// Fragments of structures: small connected components beside the largest one.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "format/content/structure_graph.h"
#include "preprocess/import/membership_volume.h"

namespace splatlas {

struct StructureFragments {
  StructureIndex structure = kNoStructure;
  std::uint64_t components = 0;
  std::uint64_t voxels = 0;  ///< of all these components
  friend bool operator==(const StructureFragments&, const StructureFragments&) = default;
};

/// A component of a structure: face-connected voxels.
struct StructureComponent {
  StructureIndex structure = kNoStructure;
  std::uint64_t voxels = 0;
  std::size_t first = 0;  ///< voxel with the lowest offset
};

/// All components of the structures below `structures`, by their first voxel. Cost: as find_fragments().
[[nodiscard]] std::vector<StructureComponent> list_components(const MembershipVolume& memberships,
                                                              std::size_t structures);

/// Calls take(voxel or kBeyondGrid) for face neighbours of `seed`, and of all voxels for which it is true.
inline constexpr std::size_t kBeyondGrid = static_cast<std::size_t>(-1);
template <typename Take>
void flood_voxels(const Index3& size, std::size_t seed, const Take& take) {
  const std::array<std::int64_t, 3> steps{1, size[0], size[0] * size[1]};
  std::vector<std::size_t> pending{seed};
  while (!pending.empty()) {
    const auto at = static_cast<std::int64_t>(pending.back());
    pending.pop_back();
    for (std::size_t a = 0; a < 3; ++a) {
      for (const std::int64_t side : {-1, 1}) {
        const std::int64_t place = at / steps[a] % size[a] + side;
        const auto beside = static_cast<std::size_t>(at + side * steps[a]);
        const bool is_inside = place >= 0 && place < size[a];
        if (take(is_inside ? beside : kBeyondGrid)) pending.push_back(beside);
      }
    }
  }
}

/// Counts the components of fewer than `below[s]` voxels of each structure s, without its largest component,
/// or without the first of several largest ones. Structures beyond `below`, and those with 0, are left out.
/// Components are face-connected, as in segments by threshold: marching cubes separates voxels that share
/// only an edge or a corner. Returns the structures with fragments, by index. Union-find over runs of a
/// scanline. One pass. Memory: the runs of two slices, and 24 bytes per run that touches no earlier one.
[[nodiscard]] std::vector<StructureFragments> find_fragments(const MembershipVolume& memberships,
                                                             std::span<const std::uint64_t> below);

/// The same, and removes the structure from the voxels of its fragments. Other structures keep them. Voxels
/// that are empty then, and enclosed by structures, get the set that most neighbours of the hole have.
std::vector<StructureFragments> drop_fragments(MembershipVolume& memberships,
                                               std::span<const std::uint64_t> below);

}  // namespace splatlas
