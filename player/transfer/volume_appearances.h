// From grey values to light: what one voxel emits and absorbs.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "format/atlas_reader.h"
#include "format/decision_tree.h"
#include "format/selection.h"
#include "player/transfer/transfer_table.h"

namespace splatlas {

/// How the volume of one structure looks: linear light, extinction in 1/mm.
struct VolumeAppearance {
  std::array<float, 3> color{1, 1, 1};
  float extinction_per_mm = 0;              ///< where the transfer function is densest
  const TransferTable* transfer = nullptr;  ///< of classes that are drawn as volume

  /// Of `count` voxels, by their grey values; arguments as those of TransferTable::look_up().
  /// The look has a transfer function.
  void look_up(const std::byte* values, std::size_t first, std::size_t stride, std::size_t count,
               ClassifiedVoxel* voxels) const {
    transfer->look_up(values, first, stride, count, extinction_per_mm, voxels);
  }
  /// The same, apart.
  void look_up(const std::byte* values, std::size_t first, std::size_t stride, std::size_t count,
               float* extinctions, float* emissions) const {
    transfer->look_up(values, first, stride, count, extinction_per_mm, extinctions, emissions);
  }
  friend bool operator==(const VolumeAppearance&, const VolumeAppearance&) = default;
  /// Colour times extinction, 1/mm.
  [[nodiscard]] std::array<float, 3> emission(const ClassifiedVoxel& voxel) const {
    const float share = voxel.extinction_per_mm * voxel.shade;
    return {share * color[0], share * color[1], share * color[2]};
  }
};

/// The looks of all classes of one selection after another, and the tables that they share. Not for use by
/// several threads at once, but for looks().
class VolumeAppearances {
 public:
  explicit VolumeAppearances(const Atlas& atlas);
  VolumeAppearances(const VolumeAppearances&) = delete;
  VolumeAppearances& operator=(const VolumeAppearances&) = delete;

  /// Cost: linear in the classes, plus a table for each transfer function (up to opacity) that has none yet.
  /// `plan` is that of `selection`, a selection of the atlas's graph.
  void select(const DrawPlan& plan, const Selection& selection);
  /// Of the plan's classes, in their order. Valid until the next select().
  [[nodiscard]] std::span<const VolumeAppearance> appearances() const { return appearances_; }
  /// Tables of looks of the same generation are equal where their addresses are.
  [[nodiscard]] std::uint64_t generation() const { return generation_; }

 private:
  [[nodiscard]] VolumeAppearance appearance_of(const StructureDraw& draw);
  [[nodiscard]] const TransferTable& table_of(const TransferShape& shape);

  VoxelType type_;
  Display display_;
  double reference_length_mm_;
  std::map<TransferShape, TransferTable> tables_;
  const TransferTable* plain_;  // of a structure without any words about it
  std::vector<VolumeAppearance> appearances_;
  std::uint64_t generation_ = 0;
};

}  // namespace splatlas
