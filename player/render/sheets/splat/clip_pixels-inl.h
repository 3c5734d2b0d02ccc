// Clip policies of the splat kernels: fractions of slabs at blocks of pixels. For every instruction set.
#if defined(SPLATLAS_PLAYER_CLIP_PIXELS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SPLATLAS_PLAYER_CLIP_PIXELS_INL_H_
#undef SPLATLAS_PLAYER_CLIP_PIXELS_INL_H_
#else
#define SPLATLAS_PLAYER_CLIP_PIXELS_INL_H_
#endif

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include <hwy/highway.h>

#include "player/render/sheets/splat/block_runs.h"
#include "player/render/sheets/splat/splat_kernels.h"
#include "player/render/simd/wide_vector-inl.h"

HWY_BEFORE_NAMESPACE();
namespace splatlas::HWY_NAMESPACE {

/// The fraction 1 of a slab.
struct WholeSlab {};

/// Optical depth or weight of a fraction of a slab.
template <class V>
HWY_INLINE V Clipped(WholeSlab /*fraction*/, V value) {
  return value;
}
template <class V>
HWY_INLINE V Clipped(V fraction, V value) {
  return Mul(fraction, value);
}

/// Clip policy of Splat for whole slabs; members as in PixelClip.
struct NoPixelClip {
  static constexpr bool kHasAllGroups = true;
  [[nodiscard]] HWY_INLINE NoPixelClip PhaseRow(std::int64_t /*row*/, std::int64_t /*phase*/) const {
    return {};
  }
  HWY_INLINE Blocks BeginPair(const SheetRows& /*rows*/, std::int64_t /*pair*/, const Blocks& reach) {
    return reach;
  }
  [[nodiscard]] HWY_INLINE bool OnlyCarries(std::int64_t /*block*/) const { return false; }
  HWY_INLINE void BeginBlock(std::int64_t /*block*/) {}
  [[nodiscard]] HWY_INLINE bool IsWhole() const { return true; }
  HWY_INLINE WholeSlab Fraction(auto...) const { return {}; }
};

/// Clip policy of Splat for slabs that planes cut.
class PixelClip {
 public:
  /// True if groups of all sizes have a kernel. Else, those that only borders of bands need have none.
  static constexpr bool kHasAllGroups = false;

  HWY_INLINE explicit PixelClip(const ClipRows& rows) : rows_(rows) {}

  /// Policy of a single phase row.
  [[nodiscard]] HWY_INLINE PixelClip PhaseRow(std::int64_t row, std::int64_t phase) const {
    ClipRows rows = rows_;
    rows.lines += row * rows.row_stride + phase * rows.phase_stride;
    return PixelClip(rows);
  }

  /// Begins a pair of rows. Blocks within reach to visit.
  HWY_INLINE Blocks BeginPair(const SheetRows& rows, std::int64_t pair, const Blocks& reach) {
    lines_ = rows_.lines + pair * rows_.pair_stride;
    visible_ = whole_ = {};
    const ClipPixels& pixels = rows_.pixels[pair];
    if (pixels.first_visible < pixels.last_visible) {
      std::int64_t min_shift = rows.phases[0].shift, max_shift = min_shift;
      for (std::size_t phase = 1; phase < rows.phase_count; ++phase) {
        min_shift = std::min(min_shift, rows.phases[phase].shift);
        max_shift = std::max(max_shift, rows.phases[phase].shift);
      }
      visible_ = {((pixels.first_visible - max_shift) >> kBlockBits) - 1,
                  (pixels.last_visible - min_shift + kBlock - 1) >> kBlockBits};
      whole_ = {(pixels.first_whole - min_shift + kBlock - 1) >> kBlockBits,
                (pixels.last_whole - max_shift) >> kBlockBits};
    }
    return {std::max(reach.first, visible_.first), std::min(reach.last, visible_.last)};
  }
  /// True for a block in front of the visible ones, which only supplies the carry.
  [[nodiscard]] HWY_INLINE bool OnlyCarries(std::int64_t block) const { return block == visible_.first; }
  HWY_INLINE void BeginBlock(std::int64_t block) { block_ = block; }
  /// True if the slab is whole at all pixels of the block.
  [[nodiscard]] HWY_INLINE bool IsWhole() const { return whole_.contains(block_); }

  /// Fraction of the slab at pixels of the block: those from `shift` on in a phase row.
  template <class D>
  HWY_INLINE WideVec<D> Fraction(D d, int row, int phase, std::int64_t shift) const {
    alignas(64) static constexpr float kNumbers[kBlock] = {0, 1, 2,  3,  4,  5,  6,  7,
                                                           8, 9, 10, 11, 12, 13, 14, 15};
    const auto zero = Zero(d), one = Set(d, 1.0f);
    const auto numbers = Load(d, kNumbers);
    const std::int64_t first = block_ * kBlock + shift;
    const ClipLine* line = lines_ + row * rows_.row_stride + phase * rows_.phase_stride;
    auto entering = one, leaving = one;
    for (int n = 0; n < rows_.planes; ++n, ++line) {
      const auto steps = Add(numbers, Set(d, static_cast<float>(first - line->whole)));
      const auto fraction = FusedMulAdd(d, Set(d, line->per_pixel), steps, Set(d, line->at_whole));
      if (n < rows_.entering) {
        entering = Min(entering, fraction);
      } else {
        leaving = Min(leaving, fraction);
      }
    }
    return Max(Sub(Add(Max(entering, zero), Max(leaving, zero)), one), zero);
  }

 private:
  ClipRows rows_;
  const ClipLine* lines_ = nullptr;  // of the pair
  Blocks visible_;                   // of the pair: to visit, with the block before, which supplies the carry
  Blocks whole_;                     // of the pair
  std::int64_t block_ = 0;
};

}  // namespace splatlas::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // SPLATLAS_PLAYER_CLIP_PIXELS_INL_H_
