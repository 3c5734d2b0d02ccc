// Fragments of structures: small connected components beside the largest one.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "format/content/structure_graph.h"
#include "preprocess/import/membership_volume.h"

namespace splatlas {

/// Fragments of one structure.
struct StructureFragments {
  StructureIndex structure = kNoStructure;
  std::uint64_t components = 0;
  std::uint64_t voxels = 0;  ///< of all these components
  friend bool operator==(const StructureFragments&, const StructureFragments&) = default;
};

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
