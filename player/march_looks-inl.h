// From grey values along a ray to what a step of it emits and absorbs. Compiled once for every instruction
// set.
#if defined(SPLATLAS_PLAYER_MARCH_LOOKS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SPLATLAS_PLAYER_MARCH_LOOKS_INL_H_
#undef SPLATLAS_PLAYER_MARCH_LOOKS_INL_H_
#else
#define SPLATLAS_PLAYER_MARCH_LOOKS_INL_H_
#endif

#include <hwy/highway.h>

#include "player/absorption-inl.h"
#include "player/march_kernels.h"
#include "player/march_samples-inl.h"

HWY_BEFORE_NAMESPACE();
namespace splatlas::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// A row of a curve's table at the segments given.
HWY_INLINE Vector LookUp(const GreyCurve& curve, GreyCurve::Row row, IntVector segment) {
  const Lanes d;
  const float* table = curve.row(row);
  if (HWY_LIKELY(curve.points() < hn::Lanes(d))) {
    return hn::TableLookupLanes(hn::Load(d, table), hn::IndicesFromVec(d, segment));
  }
  return hn::GatherIndex(d, table, segment);
}

HWY_INLINE IntVector SegmentOf(const GreyCurve& curve, Vector grey) {
  const Lanes d;
  const Ints di;
  const float* greys = curve.row(GreyCurve::kGrey) + 1;
  const auto points = static_cast<std::int32_t>(curve.points());
  auto segment = hn::Zero(di);
  if (HWY_LIKELY(curve.points() < hn::Lanes(d))) {
    for (std::int32_t n = 0; n < points; ++n) {
      const auto above = hn::RebindMask(di, hn::Ge(grey, hn::Set(d, greys[n])));
      segment = hn::IfThenElse(above, hn::Set(di, n + 1), segment);
    }
    return segment;
  }
  for (std::int32_t step = 256; step > 0; step /= 2) {
    const auto next = hn::Add(segment, hn::Set(di, step));
    const auto beyond = hn::Gt(next, hn::Set(di, points));
    const auto at = hn::Sub(hn::Min(next, hn::Set(di, points)), hn::Set(di, 1));
    const auto above = hn::RebindMask(di, hn::Ge(grey, hn::GatherIndex(d, greys, at)));
    segment = hn::IfThenElse(hn::AndNot(beyond, above), next, segment);
  }
  return segment;
}

/// A grey value and what it stands for.
struct Classified {
  Vector grey, extinction, shade;
  IntVector segment;
};

/// What the extinction rises and falls by up to a grey value.
HWY_INLINE Vector VariationUpTo(const GreyCurve& curve, Vector grey) {
  const auto segment = SegmentOf(curve, grey);
  const auto above = hn::Sub(grey, LookUp(curve, GreyCurve::kGrey, segment));
  return hn::MulAdd(LookUp(curve, GreyCurve::kVariationSlope, segment), above,
                    LookUp(curve, GreyCurve::kVariation, segment));
}

HWY_INLINE Classified Classify(const GreyCurve& curve, Vector grey) {
  const Lanes d;
  Classified c;
  c.grey = grey;
  c.segment = SegmentOf(curve, grey);
  const auto above = hn::Sub(grey, LookUp(curve, GreyCurve::kGrey, c.segment));
  c.extinction = hn::MulAdd(LookUp(curve, GreyCurve::kExtinctionSlope, c.segment), above,
                            LookUp(curve, GreyCurve::kExtinction, c.segment));
  c.extinction = hn::Max(c.extinction, hn::Zero(d));
  c.shade = hn::MulAdd(LookUp(curve, GreyCurve::kShadeSlope, c.segment), above,
                       LookUp(curve, GreyCurve::kShade, c.segment));
  return c;
}

/// Integrals of a curve up to a grey value.
struct Integrals {
  Vector depth, emission;

  HWY_INLINE Integrals(const GreyCurve& curve, const Classified& c) {
    const Lanes d;
    const auto above = hn::Sub(c.grey, LookUp(curve, GreyCurve::kGrey, c.segment));
    const auto k = LookUp(curve, GreyCurve::kExtinction, c.segment);
    const auto k_slope = LookUp(curve, GreyCurve::kExtinctionSlope, c.segment);
    const auto s = LookUp(curve, GreyCurve::kShade, c.segment);
    const auto s_slope = LookUp(curve, GreyCurve::kShadeSlope, c.segment);
    const auto half = hn::Set(d, 0.5f);
    depth = hn::MulAdd(above, hn::MulAdd(hn::Mul(half, k_slope), above, k),
                       LookUp(curve, GreyCurve::kDepth, c.segment));
    const auto square = hn::Mul(hn::Set(d, 1.0f / 3), hn::Mul(k_slope, s_slope));
    const auto linear = hn::Mul(half, hn::MulAdd(k, s_slope, hn::Mul(k_slope, s)));
    emission = hn::MulAdd(above, hn::MulAdd(above, hn::MulAdd(above, square, linear), hn::Mul(k, s)),
                          LookUp(curve, GreyCurve::kEmission, c.segment));
  }
};

/// Means of extinction, and of extinction times shade, over the grey values from a to b.
struct Means {
  Vector extinction, emission;

  HWY_INLINE Means(const GreyCurve& curve, const Classified& a, const Classified& b) {
    const Lanes d;
    // Within a segment both are linear: exact.
    extinction = hn::Mul(hn::Set(d, 0.5f), hn::Add(a.extinction, b.extinction));
    const auto of_a = hn::Mul(a.extinction, hn::MulAdd(hn::Set(d, 2.0f), a.shade, b.shade));
    const auto of_b = hn::MulAdd(b.extinction, hn::MulAdd(hn::Set(d, 2.0f), b.shade, a.shade), of_a);
    emission = hn::Mul(hn::Set(d, 1.0f / 6), of_b);
    const auto same = hn::RebindMask(d, hn::Eq(a.segment, b.segment));
    if (HWY_LIKELY(hn::AllTrue(d, same))) return;
    const auto difference = hn::Sub(b.grey, a.grey);
    const auto close = hn::Le(hn::Abs(difference), hn::Set(d, curve.least_difference()));
    const auto linear = hn::Or(same, close);
    const auto divisor = hn::IfThenElse(linear, hn::Set(d, 1.0f), difference);
    const Integrals to_a(curve, a), to_b(curve, b);
    const auto depth = hn::Max(hn::Div(hn::Sub(to_b.depth, to_a.depth), divisor), hn::Zero(d));
    const auto light = hn::Max(hn::Div(hn::Sub(to_b.emission, to_a.emission), divisor), hn::Zero(d));
    extinction = hn::IfThenElse(linear, extinction, depth);
    emission = hn::IfThenElse(linear, emission, hn::Min(light, depth));
  }
};

/// A slab's absorbed share of the light, and the same over its depth.
struct Absorption {
  Vector absorbed, mean;

  HWY_INLINE explicit Absorption(Vector depth) {
    const Lanes d;
    if (HWY_LIKELY(hn::AllTrue(d, hn::Le(depth, hn::Set(d, kThin))))) {
      mean = ThinMean(d, depth);
      absorbed = hn::Mul(depth, mean);
    } else {
      absorbed = Absorbed(d, depth);
      mean = hn::Div(absorbed, hn::Max(depth, hn::Set(d, 1e-30f)));
    }
  }
};

}  // namespace splatlas::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // SPLATLAS_PLAYER_MARCH_LOOKS_INL_H_
