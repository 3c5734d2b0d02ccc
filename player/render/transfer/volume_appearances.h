// Appearance of the selected volumes: colour, opacity and transfer function.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "format/atlas_reader.h"
#include "format/content/decision_tree.h"
#include "format/content/selection.h"
#include "player/render/transfer/transfer_table.h"

namespace splatlas {

/// Appearance of the volume of one structure.
struct VolumeAppearance {
  std::array<float, 3> color{1, 1, 1};      ///< linear RGB
  float extinction_per_mm = 0;              ///< maximum of the transfer function
  const TransferTable* transfer = nullptr;  ///< null for classes that are not drawn as volume

  /// Classifies `count` voxels; arguments as of TransferTable::look_up(). `transfer` must not be null.
  template <typename... Output>
  void look_up(const std::byte* values, std::size_t first, std::size_t stride, std::size_t count,
               Output*... outputs) const {
    transfer->look_up(values, first, stride, count, extinction_per_mm, outputs...);
  }
  friend bool operator==(const VolumeAppearance&, const VolumeAppearance&) = default;
  /// Emission: extinction * shade * colour, 1/mm.
  [[nodiscard]] std::array<float, 3> emission(const ClassifiedVoxel& voxel) const {
    const float share = voxel.extinction_per_mm * voxel.shade;
    return {share * color[0], share * color[1], share * color[2]};
  }
};

/// Appearances of the classes of the current selection, and the lookup tables that they share. Not
/// thread-safe, except for appearances().
class VolumeAppearances {
 public:
  explicit VolumeAppearances(const Atlas& atlas);
  VolumeAppearances(const VolumeAppearances&) = delete;
  VolumeAppearances& operator=(const VolumeAppearances&) = delete;

  /// Changes the selection; `plan` must be its plan. Cost: linear in the classes, plus a table for each new
  /// transfer function; transfer functions that differ only by opacity share one.
  void select(const DrawPlan& plan, const Selection& selection);
  /// Changes to the empty plan. Does not throw.
  void clear() { appearances_.clear(); }
  /// Appearances of the plan's classes, in order. Valid until the next select() or clear().
  [[nodiscard]] std::span<const VolumeAppearance> appearances() const { return appearances_; }
  /// Within one generation, tables are equal if and only if their addresses are.
  [[nodiscard]] std::uint64_t generation() const { return generation_; }

 private:
  [[nodiscard]] VolumeAppearance appearance_of(const StructureDraw& draw);
  [[nodiscard]] const TransferTable& table_of(const TransferShape& shape);

  VoxelType type_;
  Display display_;
  double reference_length_mm_;
  std::map<TransferShape, TransferTable> tables_;
  const TransferTable* plain_;  // of the default volume style
  std::vector<VolumeAppearance> appearances_;
  std::uint64_t generation_ = 0;
};

}  // namespace splatlas
