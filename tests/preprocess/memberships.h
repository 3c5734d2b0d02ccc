// Membership volumes from explicit masks, with their structures.
#pragma once

#include <vector>

#include "preprocess/classify/classify_voxels.h"
#include "preprocess/import/membership_volume.h"
#include "preprocess/structures/build_graph.h"
#include "tests/phantom/two_spheres.h"

namespace splatlas {

/// One mask per structure, over the whole grid, i fastest.
using Masks = std::vector<std::vector<std::uint8_t>>;

inline MembershipVolume memberships_of(const Masks& masks, const Index3& size) {
  MembershipVolume memberships(size);
  for (StructureIndex s = 0; s < masks.size(); ++s) memberships.add(s, masks[s]);
  return memberships;
}

/// The class of every voxel.
inline std::vector<ClassId> volume_of(const ClassifiedVoxels& classification, const Index3& size) {
  return value_or_throw(decode_runs(classification.runs, size));
}

/// Structures "A", "B", ... without parents.
inline StructureGraph flat_graph(std::size_t structures) {
  std::vector<SourceStructure> sources(structures);
  for (std::size_t s = 0; s < structures; ++s) sources[s].name.push_back(static_cast<char>('A' + s));
  Notes notes;
  return build_graph(sources, {}, "", notes)->graph;
}

/// `value(i, j, k)` for every voxel, i fastest; true is 1.
template <typename Value>
std::vector<std::uint8_t> make_mask(const Index3& size, const Value& value) {
  std::vector<std::uint8_t> mask;
  for (std::int64_t k = 0; k < size[2]; ++k) {
    for (std::int64_t j = 0; j < size[1]; ++j) {
      for (std::int64_t i = 0; i < size[0]; ++i) mask.push_back(static_cast<std::uint8_t>(value(i, j, k)));
    }
  }
  return mask;
}

/// The balls of the golden phantom.
inline constexpr Index3 kPhantomSize{phantom::kSize, phantom::kSize, phantom::kSize};
inline Masks phantom_masks() {
  Masks masks;
  for (const phantom::Ball& ball : phantom::kBalls) {
    masks.push_back(make_mask(kPhantomSize, [&](auto i, auto j, auto k) {
      return ball.holds(static_cast<int>(i), static_cast<int>(j), static_cast<int>(k));
    }));
  }
  return masks;
}

}  // namespace splatlas
