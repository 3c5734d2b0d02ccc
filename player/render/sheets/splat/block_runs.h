// Union of the spans of two adjacent voxel rows, as runs of blocks.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>

#include "player/render/sheets/splat/splat_kernels.h"

namespace splatlas {

/// Blocks to composite: all that overlap pixels of the image in any phase. They stay within its margins.
[[nodiscard]] inline Blocks blocks_in_reach(const SheetRows& rows, const ImageRows& image) {
  std::int64_t shift = rows.phases[0].shift;
  for (std::size_t n = 1; n < rows.phase_count; ++n) shift = std::min(shift, rows.phases[n].shift);
  // Solve -kMargin <= block * kBlock + shift < columns; all other blocks overlap margins only.
  return {-((shift + ImageRows::kMargin) >> kBlockBits), (image.columns - shift + kBlock - 1) >> kBlockBits};
}

/// Blocks [first, last) of one row, and the address that block 0 would have.
struct RowBlocks {
  std::int64_t first = 0, last = 0;
  const float* origin = nullptr;

  /// Optical properties of a block; `nothing` outside.
  [[nodiscard]] const float* optics(std::int64_t block, std::int64_t block_floats,
                                    const float* nothing) const {
    return block >= first && block < last ? origin + block * block_floats : nothing;
  }
};

/// Blocks of a span within `reach`.
[[nodiscard]] inline RowBlocks blocks_of(const SliceSpans& slice, const Span& span, const Blocks& reach) {
  return {std::max<std::int64_t>(reach.first, span.first_block),
          std::min(reach.last, std::int64_t{span.first_block} + span.blocks),
          slice.optics.data() + (std::int64_t{span.offset} - span.first_block) * slice.block_floats()};
}

/// Optical properties of an empty block.
alignas(64) inline constexpr std::array<float, 4 * kBlock> kEmptyBlock{};

/// Blocks [first, last) of two scanlines, each of them present in at least one.
struct BlockRun {
  std::int64_t first = 0, last = 0;
  RowBlocks upper, lower;
};

/// Iterator over the block runs of a pair of rows within reach, in order.
class BlockRuns {
 public:
  /// `pair` is an index into the pairs of `rows`.
  BlockRuns(const SheetRows& rows, std::int64_t pair, const Blocks& reach)
      : slice_(*rows.slice),
        reach_(reach),
        upper_(rows.slice->row(rows.upper + pair)),
        lower_(rows.slice->row(rows.upper + pair + 1)) {
    advance(upper_);
    advance(lower_);
  }

  /// Advances to the next run; false at the end.
  bool next(BlockRun& run) {
    // Begin with the row whose blocks come first
    const bool upper_leads = upper_.blocks.first <= lower_.blocks.first;
    Side& lead = upper_leads ? upper_ : lower_;
    Side& other = upper_leads ? lower_ : upper_;
    if (lead.blocks.first == kEnd) return false;
    const bool both = other.blocks.first <= lead.blocks.last;
    run.upper = upper_leads || both ? upper_.blocks : RowBlocks{};
    run.lower = !upper_leads || both ? lower_.blocks : RowBlocks{};
    run.first = lead.blocks.first;
    run.last = lead.blocks.last;
    if (!both) {
      advance(lead);
      return true;
    }

    // A run has at most one span of each row: end it at the next span of the shorter row
    Side& shorter = lead.blocks.last <= other.blocks.last ? lead : other;
    Side& longer = lead.blocks.last <= other.blocks.last ? other : lead;
    run.last = longer.blocks.last;
    advance(shorter);
    if (shorter.blocks.first < run.last) {
      run.last = longer.blocks.first = shorter.blocks.first;
    } else {
      advance(longer);
    }
    return true;
  }

 private:
  static constexpr std::int64_t kEnd = std::numeric_limits<std::int64_t>::max();

  /// State of one row: the rest of its current span, and the spans after it.
  struct Side {
    std::span<const Span> spans;
    RowBlocks blocks{kEnd, kEnd, nullptr};

    explicit Side(std::span<const Span> all) : spans(all) {}
  };

  /// Advances to the next span within reach.
  void advance(Side& side) const {
    while (!side.spans.empty()) {
      side.blocks = blocks_of(slice_, side.spans.front(), reach_);
      side.spans = side.spans.subspan(1);
      if (side.blocks.first < side.blocks.last) return;
    }
    side.blocks = {kEnd, kEnd, nullptr};
  }

  const SliceSpans& slice_;
  Blocks reach_;
  Side upper_, lower_;
};

}  // namespace splatlas
