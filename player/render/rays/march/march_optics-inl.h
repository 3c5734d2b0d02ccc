// Pre-integrated transfer functions (Engel et al. 2001), radiance of ray segments. For every instruction set.
#if defined(SPLATLAS_PLAYER_MARCH_OPTICS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SPLATLAS_PLAYER_MARCH_OPTICS_INL_H_
#undef SPLATLAS_PLAYER_MARCH_OPTICS_INL_H_
#else
#define SPLATLAS_PLAYER_MARCH_OPTICS_INL_H_
#endif

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <hwy/highway.h>

#include "player/render/rays/march/march_samples-inl.h"
#include "player/render/rays/march_kernels.h"
#include "player/render/simd/absorption-inl.h"

HWY_BEFORE_NAMESPACE();
namespace splatlas::HWY_NAMESPACE {

constexpr std::size_t kSlabs = MarchGrid::kBrick;  // per batch

/// A transfer function by reference: chooses its look-up at run time; derived types, at compile time.
class AnyTransfer {
 public:
  HWY_INLINE explicit AnyTransfer(const PreintegratedTransfer& transfer) : transfer_(transfer) {}

  [[nodiscard]] HWY_INLINE const PreintegratedTransfer& operator*() const { return transfer_; }
  [[nodiscard]] HWY_INLINE const PreintegratedTransfer* operator->() const { return &transfer_; }

 private:
  const PreintegratedTransfer& transfer_;
};

/// Any number of points: look-ups are gathers.
class LongTransfer : public AnyTransfer {
 public:
  HWY_INLINE explicit LongTransfer(const PreintegratedTransfer& transfer) : AnyTransfer(transfer) {}
  static HWY_INLINE bool fits(const PreintegratedTransfer& /*transfer*/) { return true; }
};

/// A row of the table at the segments given.
HWY_INLINE Vector LookUp(const LongTransfer& transfer, PreintegratedTransfer::Row row, IntVector segment) {
  return GatherIndex(Lanes(), transfer->row(row), segment);
}
/// Segment of the transfer function that a grey value lies in.
HWY_INLINE IntVector SegmentOf(const LongTransfer& transfer, Vector grey) {
  const Lanes d;
  const Ints di;
  const float* greys = transfer->row(PreintegratedTransfer::kGrey) + 1;
  const auto points = static_cast<std::int32_t>(transfer->points());
  auto segment = Zero(di);
  for (std::int32_t step = 256; step > 0; step /= 2) {
    const auto next = Add(segment, Set(di, step));
    const auto beyond = Gt(next, Set(di, points));
    const auto at = Sub(Min(next, Set(di, points)), Set(di, 1));
    const auto above = RebindMask(di, Ge(grey, GatherIndex(d, greys, at)));
    segment = IfThenElse(AndNot(beyond, above), next, segment);
  }
  return segment;
}

/// So few points that a row of the table fits a native vector: look-ups are permutations.
class ShortTransfer : public AnyTransfer {
 public:
  HWY_INLINE explicit ShortTransfer(const PreintegratedTransfer& transfer) : AnyTransfer(transfer) {}
  static HWY_INLINE bool fits(const PreintegratedTransfer& transfer) {
    return transfer.points() < hn::MaxLanes(hn::CappedTag<float, kPacketRays>());
  }
};

template <class V>
HWY_INLINE auto Permute(const float* row, V indices) {
  const hn::Rebind<float, hn::DFromV<V>> d;
  const auto lanes = hn::IndicesFromVec(d, indices);
#if HWY_TARGET == HWY_WASM  // Highway emulates it byte by byte
  return hn::Vec<decltype(d)>{wasm_i8x16_swizzle(hn::Load(d, row).raw, lanes.raw)};
#else
  return hn::TableLookupLanes(hn::Load(d, row), lanes);
#endif
}
template <class V>
HWY_INLINE auto Permute(const float* row, const Pair<V>& indices) {
  return MakePair(Permute(row, indices.low), Permute(row, indices.high));
}
HWY_INLINE Vector LookUp(const ShortTransfer& transfer, PreintegratedTransfer::Row row, IntVector segment) {
  return Permute(transfer->row(row), segment);
}
HWY_INLINE IntVector SegmentOf(const ShortTransfer& transfer, Vector grey) {
  const Lanes d;
  const Ints di;
  const float* greys = transfer->row(PreintegratedTransfer::kGrey) + 1;
  auto segment = Zero(di);
  for (std::size_t n = 0; n < transfer->points(); ++n) {
    const auto above = RebindMask(di, Ge(grey, Set(d, greys[n])));
    segment = Sub(segment, VecFromMask(di, above));
  }
  return segment;
}

HWY_INLINE Vector LookUp(const AnyTransfer& any, PreintegratedTransfer::Row row, IntVector segment) {
  if (HWY_LIKELY(ShortTransfer::fits(*any))) return LookUp(ShortTransfer(*any), row, segment);
  return LookUp(LongTransfer(*any), row, segment);
}
HWY_INLINE IntVector SegmentOf(const AnyTransfer& any, Vector grey) {
  if (HWY_LIKELY(ShortTransfer::fits(*any))) return SegmentOf(ShortTransfer(*any), grey);
  return SegmentOf(LongTransfer(*any), grey);
}

/// A grey value and its optical properties: extinction in 1/mm, shade as a factor of the colour.
struct Classified {
  Vector grey, extinction, shade;
  IntVector segment;
};

/// Total variation of the extinction up to a grey value of a segment, 1/mm.
template <typename Transfer>
HWY_INLINE Vector VariationUpTo(const Transfer& transfer, Vector grey, IntVector segment) {
  const auto above = Sub(grey, LookUp(transfer, PreintegratedTransfer::kGrey, segment));
  return MulAdd(LookUp(transfer, PreintegratedTransfer::kVariationSlope, segment), above,
                LookUp(transfer, PreintegratedTransfer::kVariation, segment));
}

template <typename Transfer>
HWY_INLINE Vector VariationUpTo(const Transfer& transfer, Vector grey) {
  return VariationUpTo(transfer, grey, SegmentOf(transfer, grey));
}

template <typename Transfer>
HWY_INLINE Classified Classify(const Transfer& transfer, Vector grey) {
  const Lanes d;
  Classified c;
  c.grey = grey;
  c.segment = SegmentOf(transfer, grey);
  const auto above = Sub(grey, LookUp(transfer, PreintegratedTransfer::kGrey, c.segment));
  c.extinction = MulAdd(LookUp(transfer, PreintegratedTransfer::kExtinctionSlope, c.segment), above,
                        LookUp(transfer, PreintegratedTransfer::kExtinction, c.segment));
  c.extinction = Max(c.extinction, Zero(d));
  c.shade = MulAdd(LookUp(transfer, PreintegratedTransfer::kShadeSlope, c.segment), above,
                   LookUp(transfer, PreintegratedTransfer::kShade, c.segment));
  return c;
}

/// Integrals of extinction and emission over the grey values up to one.
struct PrefixIntegrals {
  Vector depth, emission;

  template <typename Transfer>
  HWY_INLINE PrefixIntegrals(const Transfer& transfer, const Classified& c) {
    const Lanes d;
    const auto above = Sub(c.grey, LookUp(transfer, PreintegratedTransfer::kGrey, c.segment));
    const auto k = LookUp(transfer, PreintegratedTransfer::kExtinction, c.segment);
    const auto k_slope = LookUp(transfer, PreintegratedTransfer::kExtinctionSlope, c.segment);
    const auto s = LookUp(transfer, PreintegratedTransfer::kShade, c.segment);
    const auto s_slope = LookUp(transfer, PreintegratedTransfer::kShadeSlope, c.segment);
    const auto half = Set(d, 0.5f);
    depth = MulAdd(above, MulAdd(Mul(half, k_slope), above, k),
                   LookUp(transfer, PreintegratedTransfer::kDepth, c.segment));
    const auto square = Mul(Set(d, 1.0f / 3), Mul(k_slope, s_slope));
    const auto linear = Mul(half, MulAdd(k, s_slope, Mul(k_slope, s)));
    emission = MulAdd(above, MulAdd(above, MulAdd(above, square, linear), Mul(k, s)),
                      LookUp(transfer, PreintegratedTransfer::kEmission, c.segment));
  }
};

/// Extinction and emission (extinction * shade) of a ray segment: their means over the grey values from one
/// end to the other (Engel et al. 2001).
struct PreintegratedMeans {
  Vector extinction, emission;

  template <typename Transfer>
  HWY_INLINE PreintegratedMeans(const Transfer& transfer, const Classified& a, const Classified& b) {
    const Lanes d;
    // Both are linear within a segment of the transfer function: exact.
    extinction = Mul(Set(d, 0.5f), Add(a.extinction, b.extinction));
    const auto of_a = Mul(a.extinction, MulAdd(Set(d, 2.0f), a.shade, b.shade));
    const auto of_b = MulAdd(b.extinction, MulAdd(Set(d, 2.0f), b.shade, a.shade), of_a);
    emission = Mul(Set(d, 1.0f / 6), of_b);
    const auto same = RebindMask(d, Eq(a.segment, b.segment));
    if (HWY_LIKELY(AllTrue(d, same))) return;
    // Elsewhere: difference quotients of the prefix integrals.
    const auto difference = Sub(b.grey, a.grey);
    const auto close = Le(Abs(difference), Set(d, transfer->min_difference()));
    const auto linear = Or(same, close);
    const auto divisor = IfThenElse(linear, Set(d, 1.0f), difference);
    const PrefixIntegrals to_a(transfer, a), to_b(transfer, b);
    const auto mean_k = Max(Div(Sub(to_b.depth, to_a.depth), divisor), Zero(d));
    const auto mean_e = Max(Div(Sub(to_b.emission, to_a.emission), divisor), Zero(d));
    extinction = IfThenElse(linear, extinction, mean_k);
    emission = IfThenElse(linear, emission, Min(mean_e, mean_k));
  }

  /// Corrects the means, to first order, for a mean grey value that lies `shift` above the chord from a to b.
  template <typename Transfer>
  HWY_INLINE void ShiftGrey(const Transfer& transfer, const Classified& a, const Classified& b,
                            Vector shift) {
    const Lanes d;
    const auto half = Set(d, 0.5f);
    const auto same = RebindMask(d, Eq(a.segment, b.segment));
    auto k_slope = LookUp(transfer, PreintegratedTransfer::kExtinctionSlope, a.segment);
    const auto shade = Mul(half, Add(a.shade, b.shade));
    auto e_slope = MulAdd(extinction, LookUp(transfer, PreintegratedTransfer::kShadeSlope, a.segment),
                          Mul(k_slope, shade));
    if (HWY_UNLIKELY(!AllTrue(d, same))) {
      const auto difference = Sub(b.grey, a.grey);
      const auto close = Le(Abs(difference), Set(d, transfer->min_difference()));
      const auto one = Set(d, 1.0f);
      const auto inverse = IfThenZeroElse(close, Div(one, IfThenElse(close, one, difference)));
      const auto k_rise = Sub(b.extinction, a.extinction);
      const auto e_rise = NegMulAdd(a.extinction, a.shade, Mul(b.extinction, b.shade));
      k_slope = IfThenElse(same, k_slope, Mul(k_rise, inverse));
      e_slope = IfThenElse(same, e_slope, Mul(e_rise, inverse));
      const auto limit = Mul(half, Abs(difference));
      shift = IfThenElse(same, shift, Min(Max(shift, Neg(limit)), limit));
    }
    extinction = Max(MulAdd(k_slope, shift, extinction), Zero(d));
    emission = Min(Max(MulAdd(e_slope, shift, emission), Zero(d)), extinction);
  }
};

HWY_INLINE Absorption<Vector> AbsorptionOf(Vector depth) {
  const Lanes d;
  if (HWY_LIKELY(AllTrue(d, Le(depth, Set(d, kThin))))) {
    const auto mean = ThinMean(d, depth);
    return {Mul(depth, mean), mean};
  }
  if (HWY_LIKELY(AllTrue(d, Le(depth, Set(d, kModerate))))) return ModerateAbsorption(d, depth);
  return AnyAbsorption(d, depth);
}

/// Radiance and opacity composited so far, front to back.
struct Accumulated {
  Vector color[3], opacity;
  MarchTrace* trace = nullptr;

  HWY_INLINE Vector Transmittance() const { return Sub(Set(Lanes(), 1.0f), opacity); }
  /// Records a step that has been composited.
  HWY_INLINE void Record(Vector from, Vector to) const {
    if (HWY_LIKELY(trace == nullptr)) return;
    const Lanes d;
    MarchTrace::Step& step = trace->steps[trace->count++];
    Store(from, d, step.from.data());
    Store(to, d, step.to.data());
    Store(opacity, d, step.opacity.data());
    if (trace->count == MarchTrace::kSteps) trace->take(*trace);
  }
};

/// Optical depth up to which attenuation within a segment is negligible.
constexpr float kThinSegment = 0.005f;

/// Radiance of a ray segment with extinction and emission that change from one end to the other.
class SegmentRadiance {
 public:
  /// `mean` extinction, and the extinction `before` and `after`: at the ends.
  HWY_INLINE SegmentRadiance(Vector mean, Vector before, Vector after, Vector length)
      : slab_(AbsorptionOf(Mul(mean, length))), mean_(mean), before_(before), after_(after), length_(length) {
    const Lanes d;
    is_thin_ = AllTrue(d, Le(Mul(mean, length), Set(d, kThinSegment)));
    if (is_thin_) return;
    both_ = Max(Add(before, after), Mul(mean, Set(d, kMinEnds)));
    const auto divisor = Max(Mul(mean, both_), Set(d, 1e-30f));
    inverse_ = Div(Set(d, 1.0f), divisor);
    shift_ = MulAdd(Set(d, 0.5f), slab_.absorbed, Sub(slab_.mean, Set(d, 1.0f)));
  }

  HWY_INLINE Vector Opacity() const { return slab_.absorbed; }

  /// Radiance of an emission, given like the extinction. The integral of colour(q) tau exp(-tau q) over the
  /// share q of the optical depth tau, for a colour that is linear in q: the far end is attenuated more.
  HWY_INLINE Vector Of(Vector mean, Vector before, Vector after) const {
    const Lanes d;
    const auto uniform = Mul(Mul(length_, slab_.mean), mean);
    if (is_thin_) return uniform;
    const auto color = Mul(Mul(mean, both_), inverse_);
    const auto rise = Sub(NegMulAdd(after_, color, after), NegMulAdd(before_, color, before));
    const auto slope = Mul(Mul(Add(rise, rise), mean_), inverse_);
    const auto limit = Mul(Max(color, Set(d, 1.0f)), slab_.absorbed);
    return Min(Max(MulAdd(slope, shift_, uniform), Zero(d)), limit);
  }

 private:
  Absorption<Vector> slab_;
  Vector mean_, before_, after_, length_;
  Vector both_, inverse_, shift_;  // unset for thin segments
  bool is_thin_;
};

/// Steps of a slab for an error bound `weight` that falls with the power 3/2 of the step size, the rate at
/// discontinuities of the transfer function.
HWY_INLINE int StepsOf(const MarchScene& scene, Vector weight) {
  const float ratio = MaxLane(Lanes(), weight) / (kEvenShare * scene.tolerance);
  const auto min_steps = static_cast<float>(scene.min_steps);
  if (ratio <= 1) return scene.min_steps;
  const float steps = std::ceil(std::cbrt(ratio * ratio));
  return static_cast<int>(std::clamp(steps, min_steps, static_cast<float>(scene.max_steps)));
}

}  // namespace splatlas::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // SPLATLAS_PLAYER_MARCH_OPTICS_INL_H_
