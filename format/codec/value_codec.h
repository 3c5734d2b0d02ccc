// Predictive coding of the grey values of a group of classes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "format/codec/value_filter.h"
#include "format/content/atlas_content.h"
#include "format/content/grid.h"
#include "format/content/run_model.h"
#include "format/content/voxel_type.h"
#include "format/derive/value_groups.h"
#include "format/result.h"

namespace splatlas {

/// Mean weights of the Colin 27 brain, for groups too small to fit.
inline constexpr ValueWeights kMeanWeights{36, 37, 6, -15, -15, -12, 2, 5, -4, 4, -2, 1, -5, -6};

/// Weighted linear least squares over voxels. All values are relative to the previous voxel.
class WeightFit {
 public:
  /// Adds a voxel. `from_before`: values of its neighbours, 0 for absent ones; `weight`: its own in the fit.
  void add(const std::array<float, kNeighbours.size()>& from_before, float value, float weight);
  /// The solution; kMeanWeights for fewer than a few hundred voxels.
  [[nodiscard]] ValueWeights weights() const;

 private:
  static constexpr std::size_t kSize = kNeighbours.size();
  std::array<std::array<double, kSize>, kSize> products_{};  // normal matrix, lower triangle
  std::array<double, kSize> right_side_{};                   // of the normal equations
  std::uint64_t voxels_ = 0;
};

/// The voxels of a group: `spans` in memory order, inside `box`.
struct GroupVoxels {
  std::span<const ClassSpan> spans;
  std::uint64_t voxels = 0;  ///< total of the spans
  IndexBox box;
  std::int64_t rows = 0;  ///< scanlines per slice of the grid
};

/// True if values are predicted, not stored unchanged: 8- and 16-bit integers in boxes with small slices.
[[nodiscard]] bool predicts_values(VoxelType type, const IndexBox& box, std::uint64_t voxels);
/// Encoded length in bytes.
[[nodiscard]] std::uint64_t value_code_bytes(VoxelType type, const IndexBox& box, std::uint64_t voxels);

/// Encodes the voxels' values in memory order to value_code_bytes() bytes. Memory: two bytes a voxel.
void encode_values(const GroupVoxels& group, VoxelType type, std::span<const std::byte> values,
                   std::span<std::byte> code);
/// The same in new memory.
[[nodiscard]] std::vector<std::byte> encode_values(const GroupVoxels& group, VoxelType type,
                                                   std::span<const std::byte> values);

/// Decodes the values. kInvalidAtlas for spans outside the box and for code that does not match the voxels.
/// Safe on untrusted bytes; `code` must have value_code_bytes() bytes. Cost: linear in voxels and spans.
/// Memory: three slices of the box.
[[nodiscard]] Result<std::vector<std::byte>> decode_values(const GroupVoxels& group, VoxelType type,
                                                           std::span<const std::byte> code);

/// The means of a group, encoded.
struct EncodedMeans {
  std::uint32_t blocks = 0;
  std::vector<std::byte> code;
};

/// Encodes the values of a group into `code`, which must have their length. With `means`, encodes their means
/// as well, if a file may store them. `runs`: of the class volume along z. Linear in the voxels.
[[nodiscard]] EncodedMeans encode_group(const AtlasContent& content, const RunModel& runs,
                                        const ValueGroups& groups, std::size_t group, bool means,
                                        std::span<std::byte> code);

}  // namespace splatlas
