// Splatting of slices into sheets (Westover 1990), the hot loop. Compiled for every instruction set.
#if defined(SPLATLAS_PLAYER_SPLAT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SPLATLAS_PLAYER_SPLAT_INL_H_
#undef SPLATLAS_PLAYER_SPLAT_INL_H_
#else
#define SPLATLAS_PLAYER_SPLAT_INL_H_
#endif

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include "player/render/sheets/splat/block_runs.h"
#include "player/render/sheets/splat/clip_pixels-inl.h"
#include "player/render/sheets/splat/splat_kernels.h"
#include "player/render/simd/absorption-inl.h"
#include "player/render/simd/wide_vector-inl.h"

HWY_BEFORE_NAMESPACE();
namespace splatlas::HWY_NAMESPACE {

// A block is one or more native vectors, its parts. Parts are composited one by one, to stay in registers.
// Blocks decide about absorption methods and skipping, so that all instruction sets decide alike.
using Lanes = NativeTag<WideTag<float, kBlock>>;
using Vector = WideVec<Lanes>;
constexpr auto kPart = static_cast<std::int64_t>(kLanesOf<Lanes>);
constexpr int kParts = kBlock / kPart;

/// Software prefetch: skipped blocks defeat the hardware prefetcher.
template <std::int64_t kFloats>
HWY_INLINE void PrefetchAhead(const float* block) {
  constexpr std::int64_t kBlocksAhead = 8;
  for (std::int64_t line = 0; line < kFloats; line += 16)
    hwy::Prefetch(block + kBlocksAhead * kFloats + line);
}

/// Approximation of absorption by the range of optical depths (absorption-inl.h).
enum class AbsorptionMethod { kThinSlab, kModerateSlab, kAnySlab };

/// Splatting and compositing of `kRows` rows of pixels with `kPhases` phases and `kEmissions` emissions.
/// Optical properties are scaled by the slab length on load: optical depths instead of extinctions. `Clip`: a
/// policy of clip_pixels-inl.h.
template <int kEmissions, int kRows, int kPhases, class Clip>
class Splat {
  static constexpr int kPlanes = 1 + kEmissions;
  static constexpr std::int64_t kBlockFloats = kBlock * kPlanes;
  static constexpr int kPhaseRows = kRows * kPhases;  // row by row, phase by phase
  using PhaseRows = float* const (&)[kPhaseRows];

  /// Values of a plane at voxels of a part, and differences to the previous voxels.
  struct Voxels {
    Vector here, step;
  };

 public:
  HWY_INLINE Splat(const SheetRows& rows, const Clip& clip, float slab_mm, float termination_threshold,
                   const ImageRows& image)
      : rows_(rows),
        image_(image),
        clip_(clip),
        reach_(blocks_in_reach(rows, image)),
        next_hidden_(HiddenBlocks(0)),
        slab_(Set(Lanes(), slab_mm)),
        opaque_(Set(Lanes(), 1.0f - termination_threshold)) {
    for (int row = 0; row < kRows; ++row)
      lower_[row] = Set(Lanes(), rows.lower_weights[static_cast<std::size_t>(row)]);
    for (int phase = 0; phase < kPhases; ++phase)
      before_[phase] = Set(Lanes(), rows.phases[static_cast<std::size_t>(phase)].before);
    ClearCarry();
  }

  HWY_INLINE void CompositePair(std::int64_t pair) {
    // Find hidden blocks one pair ahead, to prefetch visible ones
    pair_ = pair;
    const Blocks hidden = next_hidden_;
    next_hidden_ = pair + 1 < rows_.pairs ? HiddenBlocks(pair + 1) : kNone;
    if (next_hidden_.first != kNoBlock) PrefetchVisible(rows_.upper + pair + 2, next_hidden_);

    // Composite visible blocks run by run
    BlockRuns runs(rows_, pair, clip_.BeginPair(rows_, pair, reach_));
    std::int64_t next_block = std::numeric_limits<std::int64_t>::min();
    for (BlockRun run; runs.next(run);) {
      if (run.first != next_block) ClearCarry();
      next_block = run.last;
      for (std::int64_t block = run.first; block < run.last;) {
        if (clip_.OnlyCarries(block)) {
          SkipTo(run, block);
          ++block;
          continue;
        }
        if (hidden.contains(block)) {
          block = std::min(hidden.last, run.last);
          SkipTo(run, block - 1);
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

  [[nodiscard]] HWY_INLINE OpaquePixels& OpaqueOf(std::int64_t pair, int phase_row) const {
    return image_.opaque[pair * image_.opaque_pair_stride + phase_row / kPhases * image_.opaque_row_stride +
                         phase_row % kPhases];
  }
  [[nodiscard]] HWY_INLINE std::int64_t ShiftOf(int phase_row) const {
    return rows_.phases[static_cast<std::size_t>(phase_row % kPhases)].shift;
  }

  /// Blocks whose pixels are known to be opaque in all phase rows.
  HWY_INLINE Blocks HiddenBlocks(std::int64_t pair) const {
    if (image_.opaque == nullptr) return kNone;
    Blocks hidden{-kNoBlock, kNoBlock};
    for (int n = 0; n < kPhaseRows; ++n) {
      const OpaquePixels& opaque = OpaqueOf(pair, n);
      if (opaque.first == opaque.last) return kNone;
      hidden.first = std::max(hidden.first, (opaque.first - ShiftOf(n) + kBlock - 1) >> kBlockBits);
      hidden.last = std::min(hidden.last, (opaque.last - ShiftOf(n)) >> kBlockBits);
    }
    return hidden.first < hidden.last ? hidden : kNone;
  }

  /// Prefetches the blocks of a row that are not hidden.
  HWY_INLINE void PrefetchVisible(std::int64_t row, const Blocks& hidden) const {
    for (const Span& span : rows_.slice->row(row)) {
      const RowBlocks row_blocks = blocks_of(*rows_.slice, span, reach_);
      Prefetch(row_blocks.origin, {row_blocks.first, std::min(row_blocks.last, hidden.first)});
      // The last hidden block supplies the carry.
      Prefetch(row_blocks.origin, {std::max(row_blocks.first, hidden.last - 1), row_blocks.last});
    }
  }
  static HWY_INLINE void Prefetch(const float* origin, const Blocks& blocks) {
    for (std::int64_t n = blocks.first * kBlockFloats; n < blocks.last * kBlockFloats; n += 16)
      hwy::Prefetch(origin + n);
  }

  /// Extends the known opaque pixels, or replaces them by a longer interval.
  HWY_INLINE void KeepOpaque(const Blocks& blocks) const {
    if (image_.opaque == nullptr) return;
    for (int n = 0; n < kPhaseRows; ++n) {
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
    // Find the pixels of each phase row
    float* phase_rows[kPhaseRows];
    for (int n = 0; n < kPhaseRows; ++n) {
      const int row = n / kPhases, phase = n % kPhases;
      phase_rows[n] = image_.pixels + pair_ * image_.pair_stride + row * image_.row_stride +
                      phase * image_.phase_stride + ShiftOf(n) + blocks.first * kBlock;
    }
    const bool none_hidden = next_hidden_.first == kNoBlock;
    const auto advance = [&phase_rows] {
      for (float*& pixels : phase_rows) pixels += kBlock;
    };

    // Composite blocks, and skip opaque ones
    for (std::int64_t block = blocks.first; block < blocks.last; ++block) {
      if (HWY_UNLIKELY(Opaque(phase_rows))) {
        const std::int64_t first = block;
        do {
          advance();
          ++block;
        } while (block < blocks.last && Opaque(phase_rows));
        KeepOpaque({first, block});
        SkipTo(run, block - 1);
        if (block == blocks.last) return;
      }
      const float* upper = run.upper.optics(block, kBlockFloats, kEmptyBlock.data());
      const float* lower = run.lower.optics(block, kBlockFloats, kEmptyBlock.data());
      if (none_hidden) PrefetchAhead<kBlockFloats>(lower);
      if (HWY_UNLIKELY(skipped_upper_ != nullptr)) CarryFromSkipped();
      clip_.BeginBlock(block);
      CompositeBlock(upper, lower, phase_rows);
      advance();
    }
  }

  /// Skips up to and including this block, which supplies the carry if the next block is composited.
  HWY_INLINE void SkipTo(const BlockRun& run, std::int64_t block) {
    skipped_upper_ = run.upper.optics(block, kBlockFloats, kEmptyBlock.data());
    skipped_lower_ = run.lower.optics(block, kBlockFloats, kEmptyBlock.data());
  }

  HWY_INLINE bool Opaque(PhaseRows phase_rows) const {
    const Lanes d;
    auto min_opacity = Set(d, 1.0f);
    for (const float* pixels : phase_rows) {
      for (std::int64_t part = 0; part < kBlock; part += kPart)
        min_opacity = Min(min_opacity, LoadU(d, pixels + kEmissions * image_.plane_stride + part));
    }
    return AllTrue(d, Ge(min_opacity, opaque_));
  }

  static HWY_INLINE bool AllUpTo(float limit, Vector depth) {
    return AllTrue(Lanes(), Le(depth, Set(Lanes(), limit)));
  }

  HWY_INLINE void ClearCarry() {
    for (auto& row : carry_) {
      for (Vector& carry : row) carry = Zero(Lanes());
    }
    max_depth_carry_ = Zero(Lanes());
    skipped_upper_ = nullptr;
  }

  /// Computes the carry of the last skipped block.
  HWY_INLINE void CarryFromSkipped() {
    max_depth_carry_ = Zero(Lanes());
    for (int row = 0; row < kRows; ++row) {
      for (std::int64_t part = 0; part < kBlock; part += kPart)
        max_depth_carry_ = Max(max_depth_carry_, Mix(skipped_upper_, skipped_lower_, row, 0, part));
      for (int plane = 0; plane < kPlanes; ++plane)
        carry_[row][plane] = Rotated(Mix(skipped_upper_, skipped_lower_, row, plane, kBlock - kPart));
    }
    skipped_upper_ = nullptr;
  }

  HWY_INLINE Vector Mix(const float* upper, const float* lower, int row, int plane, std::int64_t part) const {
    const Lanes d;
    const std::int64_t n = plane * kBlock + part;
    const auto above = Mul(slab_, Load(d, upper + n));
    const auto rise = FusedMulSub(d, slab_, Load(d, lower + n), above);
    return FusedMulAdd(d, lower_[row], rise, above);
  }

  /// Interpolates the next voxels of a plane between the voxel rows.
  HWY_INLINE Voxels NextVoxels(const float* upper, const float* lower, int row, int plane,
                               std::int64_t part) {
    Vector& carry = carry_[row][plane];
    Voxels voxels;
    voxels.here = Mix(upper, lower, row, plane, part);
    const auto rotated = Rotated(voxels.here);
    voxels.step = Sub(WithFirstLane(carry, rotated), voxels.here);
    carry = rotated;
    return voxels;
  }

  static HWY_INLINE Vector Between(Vector before, const Voxels& voxels) {
    return FusedMulAdd(Lanes(), before, voxels.step, voxels.here);
  }

  HWY_INLINE void CompositeBlock(const float* upper, const float* lower, PhaseRows phase_rows) {
    // Interpolate the depths
    Voxels depths[kRows][kParts];
    auto max_depth = Zero(Lanes());
    for (int row = 0; row < kRows; ++row) {
      for (int part = 0; part < kParts; ++part) {
        depths[row][part] = NextVoxels(upper, lower, row, 0, part * kPart);
        max_depth = Max(max_depth, depths[row][part].here);
      }
    }

    // Choose the absorption method: pixels are no denser than both of their voxels
    const auto max_depth_of_both = Max(max_depth, max_depth_carry_);
    max_depth_carry_ = max_depth;
    if (HWY_LIKELY(AllUpTo(kThin, max_depth_of_both))) {
      CompositeParts<AbsorptionMethod::kThinSlab>(depths, upper, lower, phase_rows);
    } else if (HWY_LIKELY(AllUpTo(kModerate, max_depth_of_both))) {
      CompositeParts<AbsorptionMethod::kModerateSlab>(depths, upper, lower, phase_rows);
    } else {
      CompositeParts<AbsorptionMethod::kAnySlab>(depths, upper, lower, phase_rows);
    }
  }

  template <AbsorptionMethod kMethod>
  HWY_INLINE void CompositeParts(const Voxels (&depths)[kRows][kParts], const float* upper,
                                 const float* lower, PhaseRows phase_rows) {
    // Skip hidden phase rows: at the edges of dense structures most pixels are opaque
    bool hidden[kPhaseRows] = {};
    if constexpr (kMethod != AbsorptionMethod::kThinSlab) {
      for (int s = 0; s < kPhaseRows; ++s)
        hidden[s] = Hidden(before_[s % kPhases], depths[s / kPhases], phase_rows[s]);
    }

    for (int part = 0; part < kParts; ++part) {
      for (int row = 0; row < kRows; ++row) {
        Voxels colors[kEmissions];
        for (int emission = 0; emission < kEmissions; ++emission)
          colors[emission] = NextVoxels(upper, lower, row, 1 + emission, part * kPart);
        for (int phase = 0; phase < kPhases; ++phase) {
          const int s = row * kPhases + phase;
          if (hidden[s]) continue;
          float* const pixels = phase_rows[s] + part * kPart;
          if (clip_.IsWhole()) {
            CompositePixels<kMethod>(before_[phase], depths[row][part], colors, pixels, WholeSlab());
          } else {
            const auto fraction = clip_.Fraction(Lanes(), row, phase, ShiftOf(s) + part * kPart);
            CompositePixels<kMethod>(before_[phase], depths[row][part], colors, pixels, fraction);
          }
        }
      }
    }
  }

  /// True if all pixels of a block are opaque or have no optical depth.
  HWY_INLINE bool Hidden(Vector before, const Voxels (&depths)[kParts], const float* pixels) const {
    const Lanes d;
    for (int part = 0; part < kParts; ++part) {
      const auto opacity = LoadU(d, pixels + kEmissions * image_.plane_stride + part * kPart);
      const auto empty = Le(Between(before, depths[part]), Zero(d));
      if (!AllTrue(d, Or(empty, Ge(opacity, opaque_)))) return false;
    }
    return true;
  }

  /// `fraction` of the slab: WholeSlab, or a Vector.
  template <AbsorptionMethod kMethod, class Fraction>
  HWY_INLINE void CompositePixels(Vector before, const Voxels& depths, const Voxels (&colors)[kEmissions],
                                  float* pixels, Fraction fraction) const {
    const Lanes d;
    float* const opacities = pixels + kEmissions * image_.plane_stride;
    const auto opacity = LoadU(d, opacities);
    const auto depth = Clipped(fraction, Between(before, depths));
    const auto transmittance = Sub(Set(d, 1.0f), opacity);
    if constexpr (kMethod == AbsorptionMethod::kThinSlab) {
      const auto weight = Mul(transmittance, ThinMean(d, depth));
      AddEmissions(Clipped(fraction, weight), before, colors, pixels);
      StoreU(FusedMulAdd(d, weight, depth, opacity), d, opacities);
    } else {
      const auto slab =
          kMethod == AbsorptionMethod::kModerateSlab ? ModerateAbsorption(d, depth) : AnyAbsorption(d, depth);
      const auto weight = Mul(transmittance, slab.mean);
      AddEmissions(Clipped(fraction, weight), before, colors, pixels);
      StoreU(FusedMulAdd(d, transmittance, slab.absorbed, opacity), d, opacities);
    }
  }

  HWY_INLINE void AddEmissions(Vector weight, Vector before, const Voxels (&colors)[kEmissions],
                               float* pixels) const {
    const Lanes d;
    for (int emission = 0; emission < kEmissions; ++emission) {
      float* const sums = pixels + emission * image_.plane_stride;
      StoreU(FusedMulAdd(d, weight, Between(before, colors[emission]), LoadU(d, sums)), d, sums);
    }
  }

  const SheetRows& rows_;
  const ImageRows& image_;
  Clip clip_;
  Blocks reach_;
  Blocks next_hidden_;
  std::int64_t pair_ = 0;
  Vector slab_, opaque_;
  Vector lower_[kRows], before_[kPhases];
  Vector carry_[kRows][kPlanes];  // rotated vectors of the previous voxels
  Vector max_depth_carry_;        // maximum depth of the previous block
  // Optical properties of the previous block if it was skipped and the carry is pending, else null.
  const float* skipped_upper_ = nullptr;
  const float* skipped_lower_ = nullptr;
};

}  // namespace splatlas::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // SPLATLAS_PLAYER_SPLAT_INL_H_
