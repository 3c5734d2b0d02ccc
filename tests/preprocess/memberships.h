// Membership volumes from explicit masks, with their structures.
#pragma once

#include <string>
#include <vector>

#include "preprocess/membership_volume.h"
#include "preprocess/structures/build_graph.h"

namespace splatlas {

/// One mask per structure, over the whole grid, i fastest.
using Masks = std::vector<std::vector<std::uint8_t>>;

inline MembershipVolume memberships_of(const Masks& masks, const Index3& size) {
  MembershipVolume memberships(size);
  for (StructureIndex s = 0; s < masks.size(); ++s) memberships.add(s, masks[s]);
  return memberships;
}

/// Structures "A", "B", ... without parents.
inline StructureGraph flat_graph(std::size_t structures) {
  std::vector<SourceStructure> sources(structures);
  for (std::size_t s = 0; s < structures; ++s) sources[s].name.push_back(static_cast<char>('A' + s));
  return build_graph(sources, {}, "")->graph;
}

/// The mask of the voxels that satisfy `holds(i, j, k)`.
template <typename Holds>
std::vector<std::uint8_t> make_mask(const Index3& size, Holds holds) {
  std::vector<std::uint8_t> mask;
  for (std::int64_t k = 0; k < size[2]; ++k) {
    for (std::int64_t j = 0; j < size[1]; ++j) {
      for (std::int64_t i = 0; i < size[0]; ++i) mask.push_back(holds(i, j, k) ? 1 : 0);
    }
  }
  return mask;
}

}  // namespace splatlas
