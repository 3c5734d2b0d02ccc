#include "player/render/sheets/splat/slice_mix.h"

#include <algorithm>
#include <limits>

namespace splatlas {
namespace {

/// Cursor over the blocks of a slice's row.
class RowCursor {
 public:
  RowCursor(const SliceSpans* slice, std::int64_t row) : slice_(slice) {
    if (slice != nullptr) spans_ = slice->row(row);
  }

  /// The first existing block at or after `block`; kNone at the end.
  [[nodiscard]] std::uint32_t next_from(std::uint32_t block) {
    while (!spans_.empty() && end() <= block) spans_ = spans_.subspan(1);
    return spans_.empty() ? kNone : std::max(block, spans_.front().first_block);
  }
  /// Number of consecutive blocks from `block`, a result of next_from().
  [[nodiscard]] std::uint32_t count_from(std::uint32_t block) const { return end() - block; }
  [[nodiscard]] const float* optics(std::uint32_t block) const {
    return slice_->optics.data() + slice_->place(spans_.front(), block << kBlockBits);
  }

  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

 private:
  [[nodiscard]] std::uint32_t end() const { return spans_.front().first_block + spans_.front().blocks; }

  const SliceSpans* slice_;
  std::span<const Span> spans_;
};

/// Appends blocks [first, first + count) to the current row of `mixed`.
void open_blocks(std::uint32_t first, std::uint32_t count, std::size_t first_of_row, SliceSpans& mixed) {
  std::vector<Span>& spans = mixed.spans;
  if (spans.size() > first_of_row && spans.back().first_block + spans.back().blocks == first) {
    spans.back().blocks += count;
    return;
  }
  const std::size_t blocks = mixed.optics.size() / static_cast<std::size_t>(mixed.block_floats());
  spans.push_back({first, count, 0, static_cast<std::uint32_t>(blocks)});
}

void mix_row(const SlicePair& pair, std::int64_t row, const Blocks& visible, const SplatKernels& kernels,
             SliceSpans& mixed) {
  RowCursor before(pair.before, row), behind(pair.behind, row);
  const auto block_floats = static_cast<std::size_t>(mixed.block_floats());
  const std::size_t first_of_row = mixed.spans.size();
  const auto end = static_cast<std::uint32_t>(std::clamp<std::int64_t>(visible.last, 0, RowCursor::kNone));
  for (auto block = static_cast<std::uint32_t>(std::max<std::int64_t>(visible.first, 0));;) {
    const std::uint32_t next_before = before.next_from(block), next_behind = behind.next_from(block);
    block = std::min(next_before, next_behind);
    if (block >= end) return;

    // Find the run of blocks with the same set of slices
    std::uint32_t count = end - block;
    for (const auto& [cursor, next] : {std::pair(&before, next_before), {&behind, next_behind}}) {
      if (next != RowCursor::kNone)
        count = std::min(count, next == block ? cursor->count_from(block) : next - block);
    }

    // Interpolate the run
    open_blocks(block, count, first_of_row, mixed);
    const std::size_t floats = count * block_floats;
    float* const optics = mixed.optics.append(floats);
    kernels.mix({next_before == block ? before.optics(block) : nullptr, 1 - pair.behind_weight},
                {next_behind == block ? behind.optics(block) : nullptr, pair.behind_weight}, floats, optics);
    block += count;
  }
}

}  // namespace

void mix_slices(const SlicePair& pair, std::int64_t first, std::int64_t last, std::span<const Blocks> visible,
                const SplatKernels& kernels, SliceSpans& mixed) {
  std::int64_t first_row = std::numeric_limits<std::int64_t>::max(), last_row = first;
  for (const SliceSpans* slice : {pair.before, pair.behind}) {
    if (slice == nullptr || slice->spans.empty()) continue;
    mixed.emissions = slice->emissions;
    first_row = std::min(first_row, slice->first_row);
    last_row = std::max(last_row, slice->last_row);
  }
  mixed.first_row = std::max(first, first_row);
  mixed.last_row = std::max(mixed.first_row, std::min(last, last_row));
  mixed.first_span.clear();
  mixed.spans.clear();
  mixed.optics.clear();
  for (std::int64_t row = mixed.first_row; row < mixed.last_row; ++row) {
    mixed.first_span.push_back(static_cast<std::uint32_t>(mixed.spans.size()));
    const Blocks all{0, RowCursor::kNone};
    mix_row(pair, row, visible.empty() ? all : visible[static_cast<std::size_t>(row - first)], kernels,
            mixed);
  }
  mixed.first_span.push_back(static_cast<std::uint32_t>(mixed.spans.size()));
}

}  // namespace splatlas
