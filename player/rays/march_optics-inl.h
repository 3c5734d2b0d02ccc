// From grey values along a ray to what a step of it emits and absorbs. Compiled once for every instruction
// set.
#if defined(SPLATLAS_PLAYER_MARCH_OPTICS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SPLATLAS_PLAYER_MARCH_OPTICS_INL_H_
#undef SPLATLAS_PLAYER_MARCH_OPTICS_INL_H_
#else
#define SPLATLAS_PLAYER_MARCH_OPTICS_INL_H_
#endif

#include <hwy/highway.h>

#include "player/rays/march_kernels.h"
#include "player/rays/march_samples-inl.h"
#include "player/rays/march_tolerance.h"
#include "player/simd/absorption-inl.h"

HWY_BEFORE_NAMESPACE();
namespace splatlas::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// A curve by reference; of which kind it is tells how it is looked up.
class LookedUpCurve {
 public:
  HWY_INLINE explicit LookedUpCurve(const PreintegratedTransfer& curve) : curve_(curve) {}

  [[nodiscard]] HWY_INLINE std::size_t points() const { return curve_.points(); }
  [[nodiscard]] HWY_INLINE const float* row(PreintegratedTransfer::Row row) const { return curve_.row(row); }
  [[nodiscard]] HWY_INLINE float min_difference() const { return curve_.min_difference(); }
  [[nodiscard]] HWY_INLINE float variation() const { return curve_.variation(); }

 private:
  const PreintegratedTransfer& curve_;
};

/// With so few points that a row of its table fits a vector: a look-up is a permutation.
class ShortCurve : public LookedUpCurve {
 public:
  static HWY_INLINE bool fits(const PreintegratedTransfer& curve) {
    return curve.points() < hn::Lanes(Lanes());
  }

  HWY_INLINE explicit ShortCurve(const PreintegratedTransfer& curve) : LookedUpCurve(curve) {}
};

/// With any number of points: a look-up is a gather.
class LongCurve : public LookedUpCurve {
 public:
  HWY_INLINE explicit LongCurve(const PreintegratedTransfer& curve) : LookedUpCurve(curve) {}
};

/// A row of a curve's table at the segments given.
HWY_INLINE Vector LookUp(const ShortCurve& curve, PreintegratedTransfer::Row row, IntVector segment) {
  const Lanes d;
  return hn::TableLookupLanes(hn::Load(d, curve.row(row)), hn::IndicesFromVec(d, segment));
}
HWY_INLINE Vector LookUp(const LongCurve& curve, PreintegratedTransfer::Row row, IntVector segment) {
  return hn::GatherIndex(Lanes(), curve.row(row), segment);
}
/// Of either kind.
HWY_INLINE Vector LookUp(const PreintegratedTransfer& curve, PreintegratedTransfer::Row row,
                         IntVector segment) {
  if (HWY_LIKELY(ShortCurve::fits(curve))) return LookUp(ShortCurve(curve), row, segment);
  return LookUp(LongCurve(curve), row, segment);
}

HWY_INLINE IntVector SegmentOf(const ShortCurve& curve, Vector grey) {
  const Lanes d;
  const Ints di;
  const float* greys = curve.row(PreintegratedTransfer::kGrey) + 1;
  auto segment = hn::Zero(di);
  for (std::size_t n = 0; n < curve.points(); ++n) {
    const auto above = hn::RebindMask(di, hn::Ge(grey, hn::Set(d, greys[n])));
    segment = hn::Sub(segment, hn::VecFromMask(di, above));
  }
  return segment;
}
HWY_INLINE IntVector SegmentOf(const LongCurve& curve, Vector grey) {
  const Lanes d;
  const Ints di;
  const float* greys = curve.row(PreintegratedTransfer::kGrey) + 1;
  const auto points = static_cast<std::int32_t>(curve.points());
  auto segment = hn::Zero(di);
  for (std::int32_t step = 256; step > 0; step /= 2) {
    const auto next = hn::Add(segment, hn::Set(di, step));
    const auto beyond = hn::Gt(next, hn::Set(di, points));
    const auto at = hn::Sub(hn::Min(next, hn::Set(di, points)), hn::Set(di, 1));
    const auto above = hn::RebindMask(di, hn::Ge(grey, hn::GatherIndex(d, greys, at)));
    segment = hn::IfThenElse(hn::AndNot(beyond, above), next, segment);
  }
  return segment;
}
HWY_INLINE IntVector SegmentOf(const PreintegratedTransfer& curve, Vector grey) {
  if (HWY_LIKELY(ShortCurve::fits(curve))) return SegmentOf(ShortCurve(curve), grey);
  return SegmentOf(LongCurve(curve), grey);
}

/// A grey value and what it stands for.
struct Classified {
  Vector grey, extinction, shade;
  IntVector segment;
};

/// What the extinction rises and falls by up to a grey value of a segment.
template <typename Curve>
HWY_INLINE Vector VariationUpTo(const Curve& curve, Vector grey, IntVector segment) {
  const auto above = hn::Sub(grey, LookUp(curve, PreintegratedTransfer::kGrey, segment));
  return hn::MulAdd(LookUp(curve, PreintegratedTransfer::kVariationSlope, segment), above,
                    LookUp(curve, PreintegratedTransfer::kVariation, segment));
}

template <typename Curve>
HWY_INLINE Vector VariationUpTo(const Curve& curve, Vector grey) {
  return VariationUpTo(curve, grey, SegmentOf(curve, grey));
}

template <typename Curve>
HWY_INLINE Classified Classify(const Curve& curve, Vector grey) {
  const Lanes d;
  Classified c;
  c.grey = grey;
  c.segment = SegmentOf(curve, grey);
  const auto above = hn::Sub(grey, LookUp(curve, PreintegratedTransfer::kGrey, c.segment));
  c.extinction = hn::MulAdd(LookUp(curve, PreintegratedTransfer::kExtinctionSlope, c.segment), above,
                            LookUp(curve, PreintegratedTransfer::kExtinction, c.segment));
  c.extinction = hn::Max(c.extinction, hn::Zero(d));
  c.shade = hn::MulAdd(LookUp(curve, PreintegratedTransfer::kShadeSlope, c.segment), above,
                       LookUp(curve, PreintegratedTransfer::kShade, c.segment));
  return c;
}

/// Integrals of a curve up to a grey value.
struct Integrals {
  Vector depth, emission;

  template <typename Curve>
  HWY_INLINE Integrals(const Curve& curve, const Classified& c) {
    const Lanes d;
    const auto above = hn::Sub(c.grey, LookUp(curve, PreintegratedTransfer::kGrey, c.segment));
    const auto k = LookUp(curve, PreintegratedTransfer::kExtinction, c.segment);
    const auto k_slope = LookUp(curve, PreintegratedTransfer::kExtinctionSlope, c.segment);
    const auto s = LookUp(curve, PreintegratedTransfer::kShade, c.segment);
    const auto s_slope = LookUp(curve, PreintegratedTransfer::kShadeSlope, c.segment);
    const auto half = hn::Set(d, 0.5f);
    depth = hn::MulAdd(above, hn::MulAdd(hn::Mul(half, k_slope), above, k),
                       LookUp(curve, PreintegratedTransfer::kDepth, c.segment));
    const auto square = hn::Mul(hn::Set(d, 1.0f / 3), hn::Mul(k_slope, s_slope));
    const auto linear = hn::Mul(half, hn::MulAdd(k, s_slope, hn::Mul(k_slope, s)));
    emission = hn::MulAdd(above, hn::MulAdd(above, hn::MulAdd(above, square, linear), hn::Mul(k, s)),
                          LookUp(curve, PreintegratedTransfer::kEmission, c.segment));
  }
};

/// Means of extinction, and of extinction times shade, over the grey values from a to b.
struct Means {
  Vector extinction, emission;

  template <typename Curve>
  HWY_INLINE Means(const Curve& curve, const Classified& a, const Classified& b) {
    const Lanes d;
    // Within a segment both are linear: exact.
    extinction = hn::Mul(hn::Set(d, 0.5f), hn::Add(a.extinction, b.extinction));
    const auto of_a = hn::Mul(a.extinction, hn::MulAdd(hn::Set(d, 2.0f), a.shade, b.shade));
    const auto of_b = hn::MulAdd(b.extinction, hn::MulAdd(hn::Set(d, 2.0f), b.shade, a.shade), of_a);
    emission = hn::Mul(hn::Set(d, 1.0f / 6), of_b);
    const auto same = hn::RebindMask(d, hn::Eq(a.segment, b.segment));
    if (HWY_LIKELY(hn::AllTrue(d, same))) return;
    const auto difference = hn::Sub(b.grey, a.grey);
    const auto close = hn::Le(hn::Abs(difference), hn::Set(d, curve.min_difference()));
    const auto linear = hn::Or(same, close);
    const auto divisor = hn::IfThenElse(linear, hn::Set(d, 1.0f), difference);
    const Integrals to_a(curve, a), to_b(curve, b);
    const auto depth = hn::Max(hn::Div(hn::Sub(to_b.depth, to_a.depth), divisor), hn::Zero(d));
    const auto light = hn::Max(hn::Div(hn::Sub(to_b.emission, to_a.emission), divisor), hn::Zero(d));
    extinction = hn::IfThenElse(linear, extinction, depth);
    emission = hn::IfThenElse(linear, emission, hn::Min(light, depth));
  }

  /// Where the grey value is `bend` above a straight line from a to b in the mean: to first order.
  template <typename Curve>
  HWY_INLINE void Bend(const Curve& curve, const Classified& a, const Classified& b, Vector bend) {
    const Lanes d;
    const auto half = hn::Set(d, 0.5f);
    const auto same = hn::RebindMask(d, hn::Eq(a.segment, b.segment));
    auto k_slope = LookUp(curve, PreintegratedTransfer::kExtinctionSlope, a.segment);
    const auto shade = hn::Mul(half, hn::Add(a.shade, b.shade));
    auto e_slope = hn::MulAdd(extinction, LookUp(curve, PreintegratedTransfer::kShadeSlope, a.segment),
                              hn::Mul(k_slope, shade));
    if (HWY_UNLIKELY(!hn::AllTrue(d, same))) {
      const auto difference = hn::Sub(b.grey, a.grey);
      const auto close = hn::Le(hn::Abs(difference), hn::Set(d, curve.min_difference()));
      const auto one = hn::Set(d, 1.0f);
      const auto inverse = hn::IfThenZeroElse(close, hn::Div(one, hn::IfThenElse(close, one, difference)));
      const auto k_rise = hn::Sub(b.extinction, a.extinction);
      const auto e_rise = hn::NegMulAdd(a.extinction, a.shade, hn::Mul(b.extinction, b.shade));
      k_slope = hn::IfThenElse(same, k_slope, hn::Mul(k_rise, inverse));
      e_slope = hn::IfThenElse(same, e_slope, hn::Mul(e_rise, inverse));
      const auto most = hn::Mul(half, hn::Abs(difference));
      bend = hn::IfThenElse(same, bend, hn::Min(hn::Max(bend, hn::Neg(most)), most));
    }
    extinction = hn::Max(hn::MulAdd(k_slope, bend, extinction), hn::Zero(d));
    emission = hn::Min(hn::Max(hn::MulAdd(e_slope, bend, emission), hn::Zero(d)), extinction);
  }
};

HWY_INLINE Absorption<Vector> AbsorptionOf(Vector depth) {
  const Lanes d;
  if (HWY_LIKELY(hn::AllTrue(d, hn::Le(depth, hn::Set(d, kThin))))) {
    const auto mean = ThinMean(d, depth);
    return {hn::Mul(depth, mean), mean};
  }
  if (HWY_LIKELY(hn::AllTrue(d, hn::Le(depth, hn::Set(d, kModerate))))) return ModerateAbsorption(d, depth);
  return AnyAbsorption(d, depth);
}

/// What has been added up along the rays.
struct Sum {
  Vector color[3], opacity;

  HWY_INLINE Vector Through() const { return hn::Sub(hn::Set(Lanes(), 1.0f), opacity); }
};

/// Up to this optical depth what is emitted in front and behind is hidden alike.
constexpr float kThinStep = 0.005f;

/// Light of a step in which extinction and emission change from one end to the other.
class StepLight {
 public:
  /// `mean`: of the extinction; `before`, `after`: at the ends.
  HWY_INLINE StepLight(Vector mean, Vector before, Vector after, Vector length)
      : slab_(AbsorptionOf(hn::Mul(mean, length))),
        mean_(mean),
        before_(before),
        after_(after),
        length_(length) {
    const Lanes d;
    is_thin_ = hn::AllTrue(d, hn::Le(hn::Mul(mean, length), hn::Set(d, kThinStep)));
    if (is_thin_) return;
    both_ = hn::Max(hn::Add(before, after), hn::Mul(mean, hn::Set(d, kMinEnds)));
    const auto divisor = hn::Max(hn::Mul(mean, both_), hn::Set(d, 1e-30f));
    inverse_ = hn::Div(hn::Set(d, 1.0f), divisor);
    shift_ = hn::MulAdd(hn::Set(d, 0.5f), slab_.absorbed, hn::Sub(slab_.mean, hn::Set(d, 1.0f)));
  }

  HWY_INLINE Vector Absorbed() const { return slab_.absorbed; }

  /// Light of an emission, likewise: what is emitted further in front is hidden less. With the share q of the
  /// optical depth t for a coordinate, and a colour that is linear in q, the integral of colour(q) t exp(-t
  /// q).
  HWY_INLINE Vector Of(Vector mean, Vector before, Vector after) const {
    const Lanes d;
    const auto light = hn::Mul(hn::Mul(length_, slab_.mean), mean);
    if (is_thin_) return light;
    const auto color = hn::Mul(hn::Mul(mean, both_), inverse_);
    const auto rise = hn::Sub(hn::NegMulAdd(after_, color, after), hn::NegMulAdd(before_, color, before));
    const auto slope = hn::Mul(hn::Mul(hn::Add(rise, rise), mean_), inverse_);
    const auto most = hn::Mul(hn::Max(color, hn::Set(d, 1.0f)), slab_.absorbed);
    return hn::Min(hn::Max(hn::MulAdd(slope, shift_, light), hn::Zero(d)), most);
  }

 private:
  Absorption<Vector> slab_;
  Vector mean_, before_, after_, length_;
  Vector both_, inverse_, shift_;  // where it is not thin
  bool is_thin_;
};

}  // namespace splatlas::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // SPLATLAS_PLAYER_MARCH_OPTICS_INL_H_
