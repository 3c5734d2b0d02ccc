#include "player/render/sheets/ids/slice_numbers.h"

#include <algorithm>

namespace splatlas {

void SliceNumbers::fill(const VoxelNumbers& source, std::int64_t slice, std::int64_t first_row,
                        std::int64_t last_row) {
  // Clear the rows
  const IndexBox& box = source.runs.box();
  first_block_ = box.first[0] >> kBlockBits;
  stride_ = ((box.last[0] >> kBlockBits) - first_block_ + 4) * kBlock;
  first_row_ = first_row;
  last_row_ = std::max(first_row, last_row);
  const auto voxels = static_cast<std::size_t>((last_row_ - first_row_) * stride_);
  numbers_.assign(voxels, 0);
  blocks_.assign(voxels / kBlock, 0);

  // Write the runs
  source.runs.for_each(slice, first_row_, last_row_, [&](const ClassRun& run, std::uint32_t draw) {
    const StructureNumber number = source.of_draw[draw];
    const std::int64_t row = (run.row - first_row_) * stride_;
    const std::int64_t begin = row + run.start + place(0) * kBlock;
    std::fill_n(numbers_.begin() + begin, run.length, number);
    for (std::int64_t block = begin >> kBlockBits; block <= (begin + run.length - 1) >> kBlockBits; ++block) {
      StructureNumber& of_block = blocks_[static_cast<std::size_t>(block)];
      of_block = of_block == 0 || of_block == number ? number : kSeveral;
    }
  });
}

void BandNumbers::begin(const VoxelNumbers& source, const Shear& shear, const SheetWindow& window,
                        const BandImage& image) {
  source_ = &source;
  shear_ = &shear;
  window_ = &window;
  first_fine_row_ = image.first_fine_row();
  last_fine_row_ = image.last_fine_row();
  for (Slice& slice : slices_) slice.number = -1;
  selected_ = {};
}

const SliceNumbers* BandNumbers::require(const SliceSpans& slice) {
  Slice& known = slices_[static_cast<std::size_t>(slice.number & 1)];
  if (known.number == slice.number) return &known.numbers;
  // Find the rows of all slabs that this slice contributes to
  std::int64_t first = slice.last_row, last = slice.first_row;
  for (const double slab : {-1.0, 0.0, 1.0}) {
    const SliceRows rows(*shear_, *window_, static_cast<double>(slice.number) + slab);
    first = std::min(first, rows.upper_from(window_->scale - 1, first_fine_row_));
    last = std::max(last, rows.upper_from(0, last_fine_row_) + 1);
  }
  known.number = slice.number;
  known.numbers.fill(*source_, slice.number, std::max(first, slice.first_row),
                     std::min(last, slice.last_row));
  return &known.numbers;
}

void BandNumbers::select(const SlicePair& pair) {
  selected_.spans = {pair.before, pair.behind};
  selected_.weights = {1 - pair.behind_weight, pair.behind_weight};
  for (std::size_t n = 0; n < 2; ++n)
    selected_.numbers[n] = selected_.spans[n] == nullptr ? nullptr : require(*selected_.spans[n]);
}

}  // namespace splatlas
