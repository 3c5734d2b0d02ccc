// The kernels once for every instruction set: Highway compiles this file again and again.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "player/sheets/splat_simd.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include "player/sheets/block_runs.h"
#include "player/sheets/splat_kernels.h"
#include "player/simd/absorption-inl.h"

HWY_BEFORE_NAMESPACE();
namespace splatlas::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::CappedTag<float, kBlock>;
using Vector = hn::Vec<Lanes>;

/// Turned vectors have their last lane first: what a vector hands on to the one behind it.
HWY_INLINE Vector Turned(Vector mixed) {
  const Lanes d;
  const hn::RebindToSigned<Lanes> di;
  const auto lanes = static_cast<std::int32_t>(hn::Lanes(d));
  const auto before = hn::And(hn::Iota(di, lanes - 1), hn::Set(di, lanes - 1));
  return hn::TableLookupLanes(mixed, hn::IndicesFromVec(d, before));
}

/// Rows come one after the other, but blocks are passed over: the machine's own prefetching falls behind.
template <std::int64_t kFloats>
HWY_INLINE void PrefetchAhead(const float* block) {
  constexpr std::int64_t kBlocksAhead = 8;
  for (std::int64_t line = 0; line < kFloats; line += 16)
    hwy::Prefetch(block + kBlocksAhead * kFloats + line);
}

/// How what slabs absorb is computed: absorption-inl.h.
enum class Way { kShort, kMiddle, kLong };

/// Splats and composites `kRows` rows of pixels with `kPhases` phases and `kEmissions` emissions. Light is
/// taken times the slab: depths instead of extinctions.
template <int kEmissions, int kRows, int kPhases>
class Splat {
  static constexpr int kPlanes = 1 + kEmissions;
  static constexpr std::int64_t kBlockFloats = kBlock * kPlanes;
  static constexpr int kStreams = kRows * kPhases;  // of pixels: row by row, phase by phase
  using Streams = float* const (&)[kStreams];
  using Planes = const Vector (&)[kPlanes];

 public:
  HWY_INLINE Splat(const SheetRows& rows, float slab_mm, float floor, const ImageRows& image)
      : rows_(rows),
        image_(image),
        reach_(blocks_in_reach(rows, image)),
        next_hidden_(HiddenBlocks(0)),
        slab_(hn::Set(Lanes(), slab_mm)),
        opaque_(hn::Set(Lanes(), 1.0f - floor)) {
    for (int row = 0; row < kRows; ++row)
      lower_[row] = hn::Set(Lanes(), rows.lower_weights[static_cast<std::size_t>(row)]);
    for (int phase = 0; phase < kPhases; ++phase)
      before_[phase] = hn::Set(Lanes(), rows.phases[static_cast<std::size_t>(phase)].before);
    ClearCarry();
  }

  HWY_INLINE void CompositePair(std::int64_t pair) {
    pair_ = pair;
    const Blocks hidden = next_hidden_;
    next_hidden_ = pair + 1 < rows_.pairs ? HiddenBlocks(pair + 1) : kNone;
    if (next_hidden_.first != kNoBlock) PrefetchVisible(rows_.upper + pair + 2, next_hidden_);
    BlockRuns runs(rows_, pair, reach_);
    std::int64_t next_block = std::numeric_limits<std::int64_t>::min();
    for (BlockRun run; runs.next(run);) {
      if (run.first != next_block) ClearCarry();
      next_block = run.last;
      for (std::int64_t block = run.first; block < run.last;) {
        if (hidden.contains(block)) {
          block = std::min(hidden.last, run.last);
          PassOver(run, block - 1);
          continue;
        }
        const std::int64_t last = block < hidden.first ? std::min(hidden.first, run.last) : run.last;
        CompositeBlocks(run, {block, last});
        block = last;
      }
    }
  }

 private:
  static constexpr std::int64_t kNoBlock = std::numeric_limits<std::int64_t>::max();
  static constexpr Blocks kNone{kNoBlock, kNoBlock};

  [[nodiscard]] HWY_INLINE OpaquePixels& OpaqueOf(std::int64_t pair, int stream) const {
    return image_.opaque[pair * image_.opaque_pair_stride + stream / kPhases * image_.opaque_row_stride +
                         stream % kPhases];
  }
  [[nodiscard]] HWY_INLINE std::int64_t ShiftOf(int stream) const {
    return rows_.phases[static_cast<std::size_t>(stream % kPhases)].shift;
  }

  /// Those whose pixels are known to be opaque in all streams.
  HWY_INLINE Blocks HiddenBlocks(std::int64_t pair) const {
    if (image_.opaque == nullptr) return kNone;
    Blocks hidden{-kNoBlock, kNoBlock};
    for (int n = 0; n < kStreams; ++n) {
      const OpaquePixels& opaque = OpaqueOf(pair, n);
      if (opaque.first == opaque.last) return kNone;
      hidden.first = std::max(hidden.first, (opaque.first - ShiftOf(n) + kBlock - 1) >> kBlockBits);
      hidden.last = std::min(hidden.last, (opaque.last - ShiftOf(n)) >> kBlockBits);
    }
    return hidden.first < hidden.last ? hidden : kNone;
  }

  /// What is seen of a row beside the blocks that are hidden.
  HWY_INLINE void PrefetchVisible(std::int64_t row, const Blocks& hidden) const {
    for (const Span& span : rows_.slice->row(row)) {
      const RowBlocks row_blocks = blocks_of(*rows_.slice, span, reach_);
      Prefetch(row_blocks.origin, {row_blocks.first, std::min(row_blocks.last, hidden.first)});
      // The last hidden one hands on what it has.
      Prefetch(row_blocks.origin, {std::max(row_blocks.first, hidden.last - 1), row_blocks.last});
    }
  }
  static HWY_INLINE void Prefetch(const float* origin, const Blocks& blocks) {
    for (std::int64_t n = blocks.first * kBlockFloats; n < blocks.last * kBlockFloats; n += 16)
      hwy::Prefetch(origin + n);
  }

  /// The longest stretch that is known is kept.
  HWY_INLINE void KeepOpaque(const Blocks& blocks) const {
    if (image_.opaque == nullptr) return;
    for (int n = 0; n < kStreams; ++n) {
      OpaquePixels& known = OpaqueOf(pair_, n);
      const OpaquePixels found{blocks.first * kBlock + ShiftOf(n), blocks.last * kBlock + ShiftOf(n)};
      if (found.first <= known.last && known.first <= found.last) {
        known = {std::min(known.first, found.first), std::max(known.last, found.last)};
      } else if (found.last - found.first > known.last - known.first) {
        known = found;
      }
    }
  }

  HWY_INLINE void CompositeBlocks(const BlockRun& run, const Blocks& blocks) {
    float* streams[kStreams];
    for (int n = 0; n < kStreams; ++n) {
      const int row = n / kPhases, phase = n % kPhases;
      streams[n] = image_.pixels + pair_ * image_.pair_stride + row * image_.row_stride +
                   phase * image_.phase_stride + ShiftOf(n) + blocks.first * kBlock;
    }
    const bool none_hidden = next_hidden_.first == kNoBlock;
    const auto advance = [&streams] {
      for (float*& stream : streams) stream += kBlock;
    };
    for (std::int64_t block = blocks.first; block < blocks.last; ++block) {
      if (HWY_UNLIKELY(Opaque(streams))) {
        const std::int64_t first = block;
        do {
          advance();
          ++block;
        } while (block < blocks.last && Opaque(streams));
        KeepOpaque({first, block});
        PassOver(run, block - 1);
        if (block == blocks.last) return;
      }
      const float* upper = run.upper.light(block, kBlockFloats, kDarkBlock.data());
      const float* lower = run.lower.light(block, kBlockFloats, kDarkBlock.data());
      if (none_hidden) PrefetchAhead<kBlockFloats>(lower);
      if (HWY_UNLIKELY(passed_upper_ != nullptr)) CarryFromPassed();
      CompositeBlock(upper, lower, streams);
      advance();
    }
  }

  /// Up to this block, which hands on what it has where the next one is not passed over.
  HWY_INLINE void PassOver(const BlockRun& run, std::int64_t block) {
    passed_upper_ = run.upper.light(block, kBlockFloats, kDarkBlock.data());
    passed_lower_ = run.lower.light(block, kBlockFloats, kDarkBlock.data());
  }

  HWY_INLINE bool Opaque(Streams streams) const {
    const Lanes d;
    auto least = hn::Set(d, 1.0f);
    for (const float* stream : streams) {
      for (std::int64_t n = 0; n < kBlock; n += static_cast<std::int64_t>(hn::Lanes(d)))
        least = hn::Min(least, hn::LoadU(d, stream + kEmissions * image_.plane_stride + n));
    }
    return hn::AllTrue(d, hn::Ge(least, opaque_));
  }

  static HWY_INLINE bool AllUpTo(float most, Vector depth) {
    return hn::AllTrue(Lanes(), hn::Le(depth, hn::Set(Lanes(), most)));
  }

  HWY_INLINE void ClearCarry() {
    for (auto& row : carry_) {
      for (Vector& carry : row) carry = hn::Zero(Lanes());
    }
    densest_carry_ = hn::Zero(Lanes());
    passed_upper_ = nullptr;
  }

  /// What the last block that was passed over hands on.
  HWY_INLINE void CarryFromPassed() {
    const Lanes d;
    const std::int64_t last = kBlock - static_cast<std::int64_t>(hn::Lanes(d));
    densest_carry_ = hn::Zero(d);
    for (int row = 0; row < kRows; ++row) {
      Vector mixed[kPlanes];
      Mix(passed_upper_ + last, passed_lower_ + last, row, mixed);
      densest_carry_ = hn::Max(densest_carry_, mixed[0]);
      for (int plane = 0; plane < kPlanes; ++plane) carry_[row][plane] = Turned(mixed[plane]);
    }
    passed_upper_ = nullptr;
  }

  HWY_INLINE void Mix(const float* upper, const float* lower, int row, Vector (&mixed)[kPlanes]) const {
    const Lanes d;
    for (int plane = 0; plane < kPlanes; ++plane) {
      const auto above = hn::Mul(slab_, hn::Load(d, upper + plane * kBlock));
      const auto below = hn::Mul(slab_, hn::Load(d, lower + plane * kBlock));
      mixed[plane] = hn::MulAdd(lower_[row], hn::Sub(below, above), above);
    }
  }

  HWY_INLINE void CompositeBlock(const float* upper, const float* lower, Streams streams) {
    const Lanes d;
    for (std::int64_t n = 0; n < kBlock; n += static_cast<std::int64_t>(hn::Lanes(d))) {
      Vector here[kRows][kPlanes], step[kRows][kPlanes];  // to the voxel before
      for (int row = 0; row < kRows; ++row) {
        Mix(upper + n, lower + n, row, here[row]);
        for (int plane = 0; plane < kPlanes; ++plane) {
          const auto turned = Turned(here[row][plane]);
          step[row][plane] =
              hn::Sub(hn::IfThenElse(hn::FirstN(d, 1), carry_[row][plane], turned), here[row][plane]);
          carry_[row][plane] = turned;
        }
      }
      // Pixels are no denser than the voxels that they lie between.
      auto densest = here[0][0];
      for (int row = 1; row < kRows; ++row) densest = hn::Max(densest, here[row][0]);
      const auto densest_of_both = hn::Max(densest, densest_carry_);
      densest_carry_ = densest;
      if (HWY_LIKELY(AllUpTo(kThin, densest_of_both))) {
        CompositeStreams<Way::kShort>(here, step, streams, n);
      } else if (HWY_LIKELY(AllUpTo(kModerate, densest_of_both))) {
        CompositeStreams<Way::kMiddle>(here, step, streams, n);
      } else {
        CompositeStreams<Way::kLong>(here, step, streams, n);
      }
    }
  }

  template <Way kWay>
  HWY_INLINE void CompositeStreams(const Vector (&here)[kRows][kPlanes], const Vector (&step)[kRows][kPlanes],
                                   Streams streams, std::int64_t n) const {
    for (int s = 0; s < kStreams; ++s)
      CompositePixels<kWay>(before_[s % kPhases], here[s / kPhases], step[s / kPhases], streams[s] + n);
  }

  template <Way kWay>
  HWY_INLINE void CompositePixels(Vector before, Planes here, Planes step, float* pixels) const {
    const Lanes d;
    float* const opacities = pixels + kEmissions * image_.plane_stride;
    const auto opacity = hn::LoadU(d, opacities);
    const auto depth = hn::MulAdd(before, step[0], here[0]);
    const auto through = hn::Sub(hn::Set(d, 1.0f), opacity);
    if constexpr (kWay == Way::kShort) {
      const auto weight = hn::Mul(through, ThinMean(d, depth));
      AddEmissions(weight, before, here, step, pixels);
      hn::StoreU(hn::MulAdd(weight, depth, opacity), d, opacities);
    } else {
      // Costs less than what follows, and at edges of what is dense most light falls on opaque pixels.
      const auto hidden = hn::Or(hn::Le(depth, hn::Zero(d)), hn::Ge(opacity, opaque_));
      if (hn::AllTrue(d, hidden)) return;
      const auto slab = kWay == Way::kMiddle ? ModerateAbsorption(d, depth) : AnyAbsorption(d, depth);
      AddEmissions(hn::Mul(through, slab.mean), before, here, step, pixels);
      hn::StoreU(hn::MulAdd(through, slab.absorbed, opacity), d, opacities);
    }
  }

  HWY_INLINE void AddEmissions(Vector weight, Vector before, Planes here, Planes step, float* pixels) const {
    const Lanes d;
    for (int emission = 0; emission < kEmissions; ++emission) {
      float* const colors = pixels + emission * image_.plane_stride;
      const auto splatted = hn::MulAdd(before, step[1 + emission], here[1 + emission]);
      hn::StoreU(hn::MulAdd(weight, splatted, hn::LoadU(d, colors)), d, colors);
    }
  }

  const SheetRows& rows_;
  const ImageRows& image_;
  Blocks reach_;
  Blocks next_hidden_;
  std::int64_t pair_ = 0;
  Vector slab_, opaque_;
  Vector lower_[kRows], before_[kPhases];
  Vector carry_[kRows][kPlanes];  // turned mixed vectors of the block before
  Vector densest_carry_;          // the densest of them
  // Of the block before where it was passed over: the carry is still to be made. Else null.
  const float* passed_upper_ = nullptr;
  const float* passed_lower_ = nullptr;
};

template <int kEmissions, int kRows, int kPhases>
HWY_INLINE void CompositePairs(const SheetRows& rows, float slab_mm, float floor, const ImageRows& image) {
  Splat<kEmissions, kRows, kPhases> splat(rows, slab_mm, floor, image);
  for (std::int64_t pair = 0; pair < rows.pairs; ++pair) splat.CompositePair(pair);
}

template <int kEmissions>
HWY_INLINE void CompositeEmissions(const SheetRows& rows, float slab_mm, float floor,
                                   const ImageRows& image) {
  switch (10 * rows.rows_between + rows.phase_count) {
    case 11: return CompositePairs<kEmissions, 1, 1>(rows, slab_mm, floor, image);
    case 12: return CompositePairs<kEmissions, 1, 2>(rows, slab_mm, floor, image);
    case 13: return CompositePairs<kEmissions, 1, 3>(rows, slab_mm, floor, image);
    case 21: return CompositePairs<kEmissions, 2, 1>(rows, slab_mm, floor, image);
    case 22: return CompositePairs<kEmissions, 2, 2>(rows, slab_mm, floor, image);
    case 33: return CompositePairs<kEmissions, 3, 3>(rows, slab_mm, floor, image);
    default: break;  // see SheetRows
  }
}

void Composite(const SheetRows& rows, float slab_mm, float floor, const ImageRows& image) {
  rows.slice->emissions == 1 ? CompositeEmissions<1>(rows, slab_mm, floor, image)
                             : CompositeEmissions<3>(rows, slab_mm, floor, image);
}

void Mix(const WeightedOptics& a, const WeightedOptics& b, std::size_t floats, float* mixed) {
  const Lanes d;
  const auto weight_a = hn::Set(d, a.weight), weight_b = hn::Set(d, b.weight);
  if (a.light == nullptr || b.light == nullptr) {
    const float* const light = a.light != nullptr ? a.light : b.light;
    const auto weight = a.light != nullptr ? weight_a : weight_b;
    for (std::size_t n = 0; n < floats; n += hn::Lanes(d))
      hn::Store(hn::Mul(weight, hn::Load(d, light + n)), d, mixed + n);
    return;
  }
  for (std::size_t n = 0; n < floats; n += hn::Lanes(d)) {
    const auto of_a = hn::Mul(weight_a, hn::Load(d, a.light + n));
    hn::Store(hn::MulAdd(weight_b, hn::Load(d, b.light + n), of_a), d, mixed + n);
  }
}

}  // namespace splatlas::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "player/simd/simd_choice.h"

namespace splatlas {
namespace {

HWY_EXPORT(Composite);
HWY_EXPORT(Mix);

void composite(const SheetRows& rows, float slab_mm, float floor, const ImageRows& image) {
  HWY_DYNAMIC_DISPATCH(Composite)(rows, slab_mm, floor, image);
}

void mix(const WeightedOptics& a, const WeightedOptics& b, std::size_t floats, float* mixed) {
  HWY_DYNAMIC_DISPATCH(Mix)(a, b, floats, mixed);
}

}  // namespace

const SplatKernels& best_kernels() {
  static const SplatKernels kKernels =
      scalar_is_forced() ? scalar_kernels() : SplatKernels{best_target(), composite, mix};
  return kKernels;
}

}  // namespace splatlas
#endif  // HWY_ONCE
