// Where the spans of a row of sheet pixels lie: runs of blocks that the same spans reach.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "player/splat_kernels.h"

namespace splatlas {

/// Blocks [first, last) of a scanline, and where the light of the first one stands in a span of each row;
/// null where no span of that row reaches them.
struct BlockRun {
  std::int64_t first = 0, last = 0;
  const float* near = nullptr;
  const float* far = nullptr;
};

/// Walks the runs of a row, in order, that reach pixels of the image or its margins.
class BlockRuns {
 public:
  BlockRuns(const SheetRow& row, const ImageRow& image)
      : light_(row.light),
        // -kMargin <= block * kBlock + shift < columns
        near_(row.near, -((row.shift + ImageRow::kMargin) >> kBlockBits),
              (image.columns - row.shift + kBlock - 1) >> kBlockBits),
        far_(row.far, near_.from, near_.until) {}

  /// False when there are no more.
  bool next(BlockRun& run) {
    run.first = std::min(near_.first, far_.first);
    if (run.first == Side::kEnd) return false;
    run.last = std::min(near_.first == run.first ? near_.last : near_.first,
                        far_.first == run.first ? far_.last : far_.first);
    run.near = near_.first == run.first ? near_.take(light_, run.last) : nullptr;
    run.far = far_.first == run.first ? far_.take(light_, run.last) : nullptr;
    return true;
  }

 private:
  /// One row of voxels: the blocks that its current span still reaches.
  class Side {
   public:
    static constexpr std::int64_t kEnd = std::numeric_limits<std::int64_t>::max();
    const std::int64_t from, until;
    std::int64_t first = kEnd, last = kEnd;

    Side(std::span<const Span> spans, std::int64_t from_block, std::int64_t until_block)
        : from(from_block), until(until_block), next_(spans.data()), end_(spans.data() + spans.size()) {
      advance();
    }
    /// Blocks up to `taken` are taken: where their light is.
    const float* take(const float* light, std::int64_t taken) {
      const float* const block = light + (origin_ + first * kBlockFloats);
      first = taken;
      if (first == last) advance();
      return block;
    }

   private:
    void advance() {
      for (; next_ != end_; ++next_) {
        first = std::max(from, static_cast<std::int64_t>(next_->first_block));
        last = std::min(until, static_cast<std::int64_t>(next_->first_block) + next_->blocks);
        if (first >= last) continue;
        origin_ = static_cast<std::int64_t>(next_->offset) - next_->first_block * kBlockFloats;
        ++next_;
        return;
      }
      first = last = kEnd;
    }

    const Span* next_;
    const Span* end_;
    std::int64_t origin_ = 0;
  };

  const float* light_;
  Side near_, far_;
};

}  // namespace splatlas
