// Small atlases from voxel masks: a slow and simple preprocess for tests of the player.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "format/atlas_content.h"
#include "format/atlas_reader.h"
#include "format/selection.h"
#include "tests/support/neighbours.h"

namespace splatlas {

/// One structure of a test atlas. The mask covers the source grid, i fastest; an empty mask makes a group.
struct TestStructure {
  std::string id;
  std::vector<bool> mask;
  Rgb color{255, 255, 255};
  std::vector<StructureIndex> parents{};
  /// Triangles in indices of the storage grid, each within one voxel. A structure with triangles is external.
  SurfaceMesh external{};
};

struct TestVolume {
  Grid grid;  ///< source grid; stored in storage_order(grid)
  std::vector<TestStructure> structures;
  VoxelBuffer values{};  ///< in the source grid; may be empty
  double window_low = 0, window_high = 1;
};

/// `holds(i, j, k)` for every voxel, i fastest.
template <typename Holds>
[[nodiscard]] std::vector<bool> make_mask(const Index3& size, const Holds& holds) {
  std::vector<bool> mask;
  for_each_voxel(size, [&](const Index3& at) { mask.push_back(holds(at[0], at[1], at[2])); });
  return mask;
}

/// A buffer of these values.
template <typename T>
[[nodiscard]] VoxelBuffer make_values(VoxelType type, const std::vector<T>& values) {
  const auto* bytes = reinterpret_cast<const std::byte*>(values.data());
  return {type, {bytes, bytes + values.size() * sizeof(T)}};
}

/// Classes from all 18 neighbours by brute force, normals from the 26 neighbours of boundary voxels, surfaces
/// by marching tetrahedra; external surfaces as given. Structures may overlap. Normals are rounded to 16
/// bits, so that files reproduce the content exactly.
[[nodiscard]] AtlasContent make_content(const TestVolume& volume);

/// Encodes and opens an atlas. Throws std::runtime_error with the library's message.
[[nodiscard]] std::shared_ptr<const Atlas> open_in_memory(const AtlasContent& content);

/// select(), but throws std::runtime_error with the library's message.
[[nodiscard]] Selection selection_of(std::string_view text, const StructureGraph& graph);

}  // namespace splatlas
