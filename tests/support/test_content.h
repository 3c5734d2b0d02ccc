// Small atlases from voxel masks: a slow and simple preprocess for tests of the player.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "format/atlas_reader.h"
#include "format/content/atlas_content.h"
#include "format/content/selection.h"
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

/// Every voxel.
[[nodiscard]] inline std::vector<bool> full_mask(const Index3& size) {
  return make_mask(size, [](auto...) { return true; });
}

/// The voxels from `first` to `last`, inclusive.
[[nodiscard]] inline std::vector<bool> box_mask(const Index3& size, const Index3& first, const Index3& last) {
  return make_mask(size, [&](std::int64_t i, std::int64_t j, std::int64_t k) {
    return i >= first[0] && i <= last[0] && j >= first[1] && j <= last[1] && k >= first[2] && k <= last[2];
  });
}

/// The voxels at less than the root of `squared_radius` from `center`, in voxels.
[[nodiscard]] inline std::vector<bool> ball_mask(const Index3& size, const Index3& center,
                                                 std::int64_t squared_radius) {
  return make_mask(size, [&](std::int64_t i, std::int64_t j, std::int64_t k) {
    const Index3 d{i - center[0], j - center[1], k - center[2]};
    return d[0] * d[0] + d[1] * d[1] + d[2] * d[2] < squared_radius;
  });
}

template <typename T>
[[nodiscard]] VoxelType voxel_type_of() {
  VoxelType found = VoxelType::kNone;
  for (std::uint8_t n = 1; n <= 8; ++n) {
    const auto type = static_cast<VoxelType>(n);
    visit_voxel_type(type, [&](auto tag) { found = std::is_same_v<decltype(tag), T> ? type : found; });
  }
  return found;
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

/// Selection::parse(), but throws std::runtime_error with the library's message.
[[nodiscard]] Selection selection_of(std::string_view text, const StructureGraph& graph);

}  // namespace splatlas
