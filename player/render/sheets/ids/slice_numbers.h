// Structure numbers of the voxels of a slice.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "player/picture.h"
#include "player/render/decode/selected_runs.h"
#include "player/render/sheets/band_image.h"
#include "player/render/sheets/spans/span_model.h"
#include "player/render/sheets/splat/slice_mix.h"
#include "player/render/view/shear.h"
#include "player/render/view/sheet_window.h"

namespace splatlas {

/// Structure numbers of the selected voxels of an atlas, as in IdImage. References must outlive it.
struct VoxelNumbers {
  const SelectedRuns& runs;
  std::span<const StructureNumber> of_draw;  ///< by index into the plan's classes
};

/// Structure numbers of some rows of a slice, decoded from its runs. 0: no selected voxel.
class SliceNumbers {
 public:
  /// A block or a set of voxels with several numbers.
  static constexpr StructureNumber kSeveral = 0xffff;

  /// Replaces the content by rows [first_row, last_row) of a slice of the grid. Keeps its memory. Cost:
  /// linear in the runs and blocks of the rows.
  void fill(const VoxelNumbers& source, std::int64_t slice, std::int64_t first_row, std::int64_t last_row);
  /// Empties it.
  void clear() { first_row_ = last_row_ = 0; }
  [[nodiscard]] bool has(std::int64_t row) const { return row >= first_row_ && row < last_row_; }
  [[nodiscard]] std::int64_t first_row() const { return first_row_; }
  [[nodiscard]] std::int64_t last_row() const { return last_row_; }

  /// Numbers of a block's voxels and of the one before: kBlock + 1 values. The row must be in the slice.
  [[nodiscard]] const StructureNumber* voxels(std::int64_t row, std::int64_t block) const {
    return &numbers_[static_cast<std::size_t>((row - first_row_) * stride_ + place(block) * kBlock - 1)];
  }
  /// Number of all selected voxels of a block; 0 if there are none, kSeveral if they differ.
  [[nodiscard]] StructureNumber block(std::int64_t row, std::int64_t block) const {
    return blocks_[static_cast<std::size_t>((row - first_row_) * (stride_ / kBlock) + place(block))];
  }

 private:
  /// Rows begin with an empty block, and end with two.
  [[nodiscard]] std::int64_t place(std::int64_t block) const { return block - first_block_ + 1; }

  std::int64_t first_row_ = 0, last_row_ = 0, first_block_ = 0, stride_ = 0;
  std::vector<StructureNumber> numbers_, blocks_;
};

/// Two slices of voxels that a slab interpolates between; null: none.
struct NumberedSlices {
  std::array<const SliceSpans*, 2> spans{};
  std::array<const SliceNumbers*, 2> numbers{};
  std::array<float, 2> weights{1, 0};
};

/// Structure numbers of the slices around a slab, in the rows of a band. Keeps its memory.
class BandNumbers {
 public:
  /// Empties it for a band. All references must outlive it.
  void begin(const VoxelNumbers& source, const Shear& shear, const SheetWindow& window,
             const BandImage& image);
  /// Selects the slices of a slab, and decodes new ones. A slab of one slice has no `behind`.
  void select(const SlicePair& pair);
  [[nodiscard]] const NumberedSlices& selected() const { return selected_; }

 private:
  struct Slice {
    std::int64_t number = -1;
    SliceNumbers numbers;
  };
  const SliceNumbers* require(const SliceSpans& slice);

  const VoxelNumbers* source_ = nullptr;
  const Shear* shear_ = nullptr;
  const SheetWindow* window_ = nullptr;
  std::int64_t first_fine_row_ = 0, last_fine_row_ = 0;
  std::array<Slice, 2> slices_;  // by parity of their numbers
  NumberedSlices selected_;
};

}  // namespace splatlas
