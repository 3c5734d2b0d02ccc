// The kernels once for every instruction set: Highway compiles this file again and again.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "player/splat_simd.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include <cstdint>
#include <limits>

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include "player/block_runs.h"
#include "player/splat_kernels.h"

HWY_BEFORE_NAMESPACE();
namespace splatlas::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::CappedTag<float, kBlock>;
using Vector = hn::Vec<Lanes>;

/// Slabs of at most this depth take the short way.
constexpr float kThin = 0.75f;

/// (1 - exp(-depth)) / depth, 0 <= depth <= kThin, to 2e-8 relative: the polynomial through the Chebyshev
/// nodes of that range.
HWY_INLINE Vector ThinMean(Vector depth) {
  const Lanes d;
  auto mean = hn::Set(d, -1.011964663e-3f);
  mean = hn::MulAdd(mean, depth, hn::Set(d, 8.033159332e-3f));
  mean = hn::MulAdd(mean, depth, hn::Set(d, -4.155307680e-2f));
  mean = hn::MulAdd(mean, depth, hn::Set(d, 1.666469833e-1f));
  mean = hn::MulAdd(mean, depth, hn::Set(d, -4.999987434e-1f));
  return hn::MulAdd(mean, depth, hn::Set(d, 1.0f));
}

/// 1 - exp(-depth) for depth >= 0 to about 1e-7 relative: exp(-depth) = 2^n * (1 + r * q(r)) with |r| <=
/// ln(2) / 2, so that the difference from 1 never cancels for small depths.
HWY_INLINE Vector Absorbed(Vector depth) {
  const Lanes d;
  const auto one = hn::Set(d, 1.0f);
  const auto x = hn::Neg(hn::Min(depth, hn::Set(d, 87.0f)));
  const auto n = hn::Round(hn::Mul(x, hn::Set(d, 1.44269504f)));
  auto r = hn::NegMulAdd(n, hn::Set(d, 0.693359375f), x);
  r = hn::NegMulAdd(n, hn::Set(d, -2.12194440e-4f), r);
  // q(r) = (exp(r) - 1) / r, Taylor: the first term left out is below 2e-8.
  auto q = hn::Set(d, 1.0f / 5040);
  q = hn::MulAdd(q, r, hn::Set(d, 1.0f / 720));
  q = hn::MulAdd(q, r, hn::Set(d, 1.0f / 120));
  q = hn::MulAdd(q, r, hn::Set(d, 1.0f / 24));
  q = hn::MulAdd(q, r, hn::Set(d, 1.0f / 6));
  q = hn::MulAdd(q, r, hn::Set(d, 0.5f));
  q = hn::MulAdd(q, r, one);
  const hn::RebindToSigned<Lanes> di;
  const auto bits = hn::ShiftLeft<23>(hn::Add(hn::ConvertTo(di, n), hn::Set(di, 127)));
  const auto scale = hn::BitCast(d, bits);
  const auto expm1 = hn::Mul(r, q);
  return hn::NegMulAdd(scale, expm1, hn::Sub(one, scale));
}

/// The weights of a row, in every lane.
struct Weights {
  Vector near, far, here, before;

  HWY_INLINE explicit Weights(const SheetRow& row)
      : near(hn::Set(Lanes(), row.near_weight)),
        far(hn::Set(Lanes(), row.far_weight)),
        here(hn::Set(Lanes(), row.here)),
        before(hn::Set(Lanes(), row.before)) {}
};

/// The rows of voxels that reach a run of blocks.
enum class Rows { kNear, kFar, kBoth };

template <Rows kRows>
HWY_INLINE Vector Mixed(const Weights& weights, const float* near, const float* far) {
  const Lanes d;
  if constexpr (kRows == Rows::kNear) return hn::Mul(weights.near, hn::Load(d, near));
  if constexpr (kRows == Rows::kFar) return hn::Mul(weights.far, hn::Load(d, far));
  return hn::MulAdd(weights.far, hn::Load(d, far), hn::Mul(weights.near, hn::Load(d, near)));
}

/// Turned vectors have their last lane first: what a vector hands on to the one behind it.
HWY_INLINE Vector Turned(Vector mixed) {
  const Lanes d;
  const hn::RebindToSigned<Lanes> di;
  const auto lanes = static_cast<std::int32_t>(hn::Lanes(d));
  const auto before = hn::And(hn::Iota(di, lanes - 1), hn::Set(di, lanes - 1));
  return hn::TableLookupLanes(mixed, hn::IndicesFromVec(d, before));
}

/// The splat: a row of pixels is the mixed row convolved with two weights. `carry` is the mixed vector before
/// this one, turned; this one's is left in it.
HWY_INLINE Vector Splatted(const Weights& weights, Vector mixed, Vector& carry) {
  const Lanes d;
  const auto turned = Turned(mixed);
  const auto before = hn::IfThenElse(hn::FirstN(d, 1), carry, turned);
  carry = turned;
  return hn::MulAdd(weights.before, before, hn::Mul(weights.here, mixed));
}

/// Turned mixed vectors of the block before, by plane.
struct Carry {
  Vector turned[kPlanes];

  HWY_INLINE void Clear() {
    for (Vector& t : turned) t = hn::Zero(Lanes());
  }
  /// From the last vectors of a block that was passed over.
  HWY_INLINE void From(const Weights& weights, const float* near, const float* far) {
    const Lanes d;
    for (std::size_t plane = 0; plane < kPlanes; ++plane) {
      const std::size_t at = (plane + 1) * kBlock - hn::Lanes(d);
      auto mixed = hn::Zero(d);
      if (near != nullptr) mixed = hn::Mul(weights.near, hn::Load(d, near + at));
      if (far != nullptr) mixed = hn::MulAdd(weights.far, hn::Load(d, far + at), mixed);
      turned[plane] = Turned(mixed);
    }
  }
};

/// Composites one block.
template <Rows kRows>
HWY_INLINE void CompositeBlock(const Weights& weights, const float* near, const float* far, Vector slab,
                               float* pixels, std::size_t stride, Carry& carry) {
  const Lanes d;
  const auto one = hn::Set(d, 1.0f);
  for (std::size_t n = 0; n < static_cast<std::size_t>(kBlock); n += hn::Lanes(d)) {
    const auto extinction = Splatted(weights, Mixed<kRows>(weights, near + n, far + n), carry.turned[0]);
    const auto depth = hn::Mul(slab, extinction);
    const auto opacity = hn::LoadU(d, pixels + 3 * stride + n);
    const auto through = hn::Sub(one, opacity);
    Vector mean, absorbed;
    if (HWY_LIKELY(hn::AllTrue(d, hn::Le(depth, hn::Set(d, kThin))))) {
      mean = ThinMean(depth);
      absorbed = hn::Mul(depth, mean);
    } else {
      absorbed = Absorbed(depth);
      mean = hn::Div(absorbed, hn::Max(depth, hn::Set(d, 1e-30f)));
    }
    const auto weight = hn::Mul(hn::Mul(through, slab), mean);
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t at = (c + 1) * kBlock + n;
      const auto emission =
          Splatted(weights, Mixed<kRows>(weights, near + at, far + at), carry.turned[c + 1]);
      float* color = pixels + c * stride + n;
      hn::StoreU(hn::MulAdd(weight, emission, hn::LoadU(d, color)), d, color);
    }
    hn::StoreU(hn::MulAdd(through, absorbed, opacity), d, pixels + 3 * stride + n);
  }
}

HWY_INLINE bool Opaque(const float* opacity, float floor) {
  const Lanes d;
  auto least = hn::LoadU(d, opacity);
  for (std::size_t n = hn::Lanes(d); n < static_cast<std::size_t>(kBlock); n += hn::Lanes(d)) {
    least = hn::Min(least, hn::LoadU(d, opacity + n));
  }
  return hn::AllTrue(d, hn::Le(hn::Sub(hn::Set(d, 1.0f), least), hn::Set(d, floor)));
}

/// Rows come one after the other, but blocks are passed over: the machine's own prefetching falls behind.
HWY_INLINE void PrefetchAhead(const float* block) {
  constexpr std::int64_t kBlocksAhead = 8;
  for (std::int64_t line = 0; line < kBlockFloats; line += 16)
    hwy::Prefetch(block + kBlocksAhead * kBlockFloats + line);
}

/// A row's walk over its blocks.
struct RowWalk {
  const SheetRow& row;
  const ImageRow& image;
  float floor;
  Weights weights;
  Vector slab;
  Carry carry;
  bool passed = false;  // the block before was passed over: the carry is still to be made
  const float* passed_near = nullptr;
  const float* passed_far = nullptr;

  HWY_INLINE RowWalk(const SheetRow& sheet_row, float slab_mm, float opaque_floor, const ImageRow& image_row)
      : row(sheet_row),
        image(image_row),
        floor(opaque_floor),
        weights(sheet_row),
        slab(hn::Set(Lanes(), slab_mm)) {
    carry.Clear();
  }

  template <Rows kRows>
  HWY_INLINE void Run(const BlockRun& run) {
    const float* near = run.near;
    const float* far = run.far;
    for (std::int64_t block = run.first; block < run.last; ++block) {
      float* pixels = image.planes + block * kBlock + row.shift;
      if (HWY_UNLIKELY(Opaque(pixels + 3 * image.stride, floor))) {
        passed = true;
        passed_near = near;
        passed_far = far;
      } else {
        PrefetchAhead(kRows == Rows::kFar ? far : near);
        if (HWY_UNLIKELY(passed)) carry.From(weights, passed_near, passed_far);
        passed = false;
        CompositeBlock<kRows>(weights, near, far, slab, pixels, image.stride, carry);
      }
      if constexpr (kRows != Rows::kFar) near += kBlockFloats;
      if constexpr (kRows != Rows::kNear) far += kBlockFloats;
    }
  }
};

void Composite(const SheetRow& row, float slab_mm, float floor, const ImageRow& image) {
  RowWalk walk(row, slab_mm, floor, image);
  BlockRuns runs(row, image);
  std::int64_t next_block = std::numeric_limits<std::int64_t>::min();
  for (BlockRun run; runs.next(run);) {
    if (run.first != next_block) {
      walk.carry.Clear();
      walk.passed = false;
    }
    next_block = run.last;
    if (run.far == nullptr) {
      walk.Run<Rows::kNear>(run);
    } else if (run.near == nullptr) {
      walk.Run<Rows::kFar>(run);
    } else {
      walk.Run<Rows::kBoth>(run);
    }
  }
}

}  // namespace splatlas::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "player/simd_choice.h"

namespace splatlas {
namespace {

HWY_EXPORT(Composite);

void composite(const SheetRow& row, float slab_mm, float floor, const ImageRow& image) {
  HWY_DYNAMIC_DISPATCH(Composite)(row, slab_mm, floor, image);
}

}  // namespace

const SplatKernels& best_kernels() {
  static const SplatKernels kKernels =
      scalar_is_forced() ? scalar_kernels() : SplatKernels{best_target(), composite};
  return kKernels;
}

}  // namespace splatlas
#endif  // HWY_ONCE
