// Small atlases from voxel masks, for tests of the player: what preprocess does, written slowly and plainly.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "format/atlas_content.h"
#include "format/atlas_reader.h"
#include "format/selection.h"

namespace splatlas {

/// One structure of a test atlas. The mask is over the source grid, i fastest; an empty one makes a group.
struct TestStructure {
  std::string id;
  std::vector<bool> mask;
  Rgb color{255, 255, 255};
  std::vector<StructureIndex> parents{};
  /// Triangles in indices of the storage grid, each in one voxel; a structure that has some is external.
  SurfaceMesh external{};
};

struct TestVolume {
  Grid grid;  ///< of the source: stored in storage_order(grid)
  std::vector<TestStructure> structures;
  VoxelBuffer values{};  ///< in the source grid; empty: the atlas has none
  double window_low = 0, window_high = 1;
};

/// `holds(i, j, k)` of every voxel, i fastest.
template <typename Holds>
[[nodiscard]] std::vector<bool> make_mask(const Index3& size, const Holds& holds) {
  std::vector<bool> mask;
  for (std::int64_t k = 0; k < size[2]; ++k) {
    for (std::int64_t j = 0; j < size[1]; ++j) {
      for (std::int64_t i = 0; i < size[0]; ++i) mask.push_back(holds(i, j, k));
    }
  }
  return mask;
}

/// A buffer of the values' type.
template <typename T>
[[nodiscard]] VoxelBuffer make_values(VoxelType type, const std::vector<T>& values) {
  const auto* bytes = reinterpret_cast<const std::byte*>(values.data());
  return {type, {bytes, bytes + values.size() * sizeof(T)}};
}

/// Classes by a brute-force look at all 18 neighbours, normals from the 26 around a boundary voxel, surfaces
/// by marching tetrahedra; external ones as they are given. Structures may overlap. Normals are rounded to 16
/// bits already, so that the content read back from a file equals what was written.
[[nodiscard]] AtlasContent make_content(const TestVolume& volume);

/// Encoded and opened again. Throws std::runtime_error with the library's message.
[[nodiscard]] std::shared_ptr<const Atlas> open_in_memory(const AtlasContent& content);

/// select() that throws std::runtime_error with the library's message.
[[nodiscard]] Selection selection_of(std::string_view text, const StructureGraph& graph);

}  // namespace splatlas
