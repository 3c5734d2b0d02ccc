#include "player/render/sheets/slabs.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace splatlas {
namespace {

/// Lower bound of transmittance. With a float resolution of 6e-8 it limits the error of the radiance in front
/// of a fragment to 1e-5.
constexpr float kMinTransmittance = 2e-4f;

}  // namespace

Slabs::Slabs(const Shear& shear, const Grid& grid, int parts)
    : ascending_(shear.ascending),
      last_slice_(static_cast<double>(grid.size[shear.scan.slice_axis]) - 1),
      count_(grid.size[shear.scan.slice_axis]) {
  if (parts == 1) return;
  count_ = (count_ + 1) * parts;
  begin_ = -1;
  thickness_ = 1.0 / parts;
}

Slabs::Place Slabs::at(double along) const {
  const double slabs = (along - begin_) / thickness_;
  const double slab = std::clamp(std::floor(slabs), 0.0, static_cast<double>(count_ - 1));
  return {static_cast<std::int32_t>(slab), static_cast<float>(std::clamp(slabs - slab, 0.0, 1.0))};
}

float Slabs::kept_part(std::int32_t slab, double depth, double from, double to) const {
  const double begin = begin_ + slab * thickness_;
  const double first = std::max(begin, along_of(from));
  const double last = std::min(begin + thickness_, along_of(to));
  if (!(first < last)) return 0;
  return static_cast<float>(std::clamp((along_of(depth) - first) / (last - first), 0.0, 1.0));
}

float share_of_slab(float absorbed, float part) {
  if (!(absorbed > 0) || part >= 1) return std::min(part, 1.0f);
  if (absorbed < 0.125f) {
    // Sum the binomial series, with a truncation error below 1e-7
    float share = 1 + absorbed * (5 - part) * (1.0f / 6);
    share = 1 + absorbed * (4 - part) * (1.0f / 5) * share;
    share = 1 + absorbed * (3 - part) * (1.0f / 4) * share;
    share = 1 + absorbed * (2 - part) * (1.0f / 3) * share;
    share = 1 + absorbed * (1 - part) * (1.0f / 2) * share;
    return part * share;
  }
  if (absorbed >= 1) return part > 0 ? 1.0f : 0.0f;
  return -std::expm1(part * std::log1p(-absorbed)) / absorbed;
}

float share_in_slab(float before, float behind, float part) {
  const float transmittance = 1 - before, added = behind - before;
  if (!(added > 0)) return 0;
  // Limit the opacity of the slab: rounding leaves too few digits of the transmittance behind it.
  const float max_added = transmittance - kMinTransmittance;
  return share_of_slab(std::min(added, std::max(max_added, 0.0f)) / transmittance, part);
}

namespace {

/// Cursor over the blocks of a slice's row.
class RowCursor {
 public:
  RowCursor(const ShownRows* shown, std::int64_t row) {
    if (shown == nullptr) return;
    slice_ = shown->slice;
    spans_ = slice_->row(row);
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

  const SliceSpans* slice_ = nullptr;
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

/// Blocks without content.
Blocks hidden_of(const ShownRows* shown, std::int64_t row) {
  return shown == nullptr || shown->hidden.empty()
             ? Blocks{}
             : shown->hidden[static_cast<std::size_t>(row - shown->rows.first)];
}

void mix_row(const SlicePair& pair, std::int64_t row, const Blocks& visible, const SplatKernels& kernels,
             SliceSpans& mixed) {
  RowCursor before(pair.before, row), behind(pair.behind, row);
  const auto block_floats = static_cast<std::size_t>(mixed.block_floats());
  const std::size_t first_of_row = mixed.first_span.back();
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

void mix_slices(const SlicePair& pair, const RowRange& rows, std::span<const Blocks> visible,
                const SplatKernels& kernels, SliceSpans& mixed) {
  RowRange all;
  for (const ShownRows* shown : {pair.before, pair.behind}) {
    if (shown == nullptr || shown->slice->spans.empty()) continue;
    mixed.emissions = shown->slice->emissions;
    all.include({shown->slice->first_row, shown->slice->last_row});
  }
  mixed.first_row = std::max(rows.first, all.first);
  mixed.last_row = std::max(mixed.first_row, std::min(rows.last, all.last));
  mixed.first_span.clear();
  mixed.spans.clear();
  mixed.optics.clear();
  for (std::int64_t row = mixed.first_row; row < mixed.last_row; ++row) {
    mixed.first_span.push_back(static_cast<std::uint32_t>(mixed.spans.size()));
    const Blocks seen =
        visible.empty() ? Blocks{0, RowCursor::kNone} : visible[static_cast<std::size_t>(row - rows.first)];
    for (const Blocks& outside : parts_outside(seen, hidden_of(pair.before, row))) {
      for (const Blocks& part : parts_outside(outside, hidden_of(pair.behind, row))) {
        if (part.first < part.last) mix_row(pair, row, part, kernels, mixed);
      }
    }
  }
  mixed.first_span.push_back(static_cast<std::uint32_t>(mixed.spans.size()));
}

}  // namespace splatlas
