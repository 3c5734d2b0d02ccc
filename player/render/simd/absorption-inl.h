// Absorption of a slab by its optical depth. Compiled once for every instruction set.
#if defined(SPLATLAS_PLAYER_ABSORPTION_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SPLATLAS_PLAYER_ABSORPTION_INL_H_
#undef SPLATLAS_PLAYER_ABSORPTION_INL_H_
#else
#define SPLATLAS_PLAYER_ABSORPTION_INL_H_
#endif

#include <hwy/highway.h>

#include "player/render/simd/wide_vector-inl.h"

HWY_BEFORE_NAMESPACE();
namespace splatlas::HWY_NAMESPACE {

/// Depth limit of ThinMean().
constexpr float kThin = 0.75f;

/// (1 - exp(-depth)) / depth, 0 <= depth <= kThin, to 1.5e-7 relative: 1 - depth / 2 + ..., the rest
/// through the Chebyshev nodes of that range.
template <class D, class V = WideVec<D>>
HWY_INLINE V ThinMean(D d, V depth) {
  auto mean = Set(d, -1.067719662e-03f);
  mean = FusedMulAdd(d, mean, depth, Set(d, 8.132654303e-03f));
  mean = FusedMulAdd(d, mean, depth, Set(d, -4.161409106e-02f));
  mean = FusedMulAdd(d, mean, depth, Set(d, 1.666617870e-01f));
  mean = FusedMulAdd(d, mean, depth, Set(d, -4.999999269e-01f));
  return FusedMulAdd(d, mean, depth, Set(d, 1.0f));
}

/// 1 - exp(-depth) for depth >= 0 to about 1e-7 relative: exp(-depth) = 2^n * (1 + r * q(r)) with |r| <=
/// ln(2) / 2, so that the difference from 1 never cancels for small depths.
template <class D, class V = WideVec<D>>
HWY_INLINE V Absorbed(D d, V depth) {
  const auto one = Set(d, 1.0f);
  const auto x = Neg(Min(depth, Set(d, 87.0f)));
  const auto n = Round(Mul(x, Set(d, 1.44269504f)));
  auto r = FusedNegMulAdd(d, n, Set(d, 0.693359375f), x);
  r = FusedNegMulAdd(d, n, Set(d, -2.12194440e-4f), r);
  // q(r) = (exp(r) - 1) / r, Taylor: the first term left out is below 2e-8.
  auto q = Set(d, 1.0f / 5040);
  q = FusedMulAdd(d, q, r, Set(d, 1.0f / 720));
  q = FusedMulAdd(d, q, r, Set(d, 1.0f / 120));
  q = FusedMulAdd(d, q, r, Set(d, 1.0f / 24));
  q = FusedMulAdd(d, q, r, Set(d, 1.0f / 6));
  q = FusedMulAdd(d, q, r, Set(d, 0.5f));
  q = FusedMulAdd(d, q, r, one);
  const SignedTag<D> di;
  const auto bits = ShiftBitsLeft<23>(Add(ConvertTo(di, n), Set(di, 127)));
  const auto scale = BitCast(d, bits);
  return FusedNegMulAdd(d, scale, Mul(r, q), Sub(one, scale));
}

/// Opacity of a slab, 1 - exp(-depth), and the same divided by its depth.
template <class V>
struct Absorption {
  V absorbed, mean;
};

constexpr int kDoublings = 3;
/// Depth limit of ModerateAbsorption().
constexpr float kModerate = kThin * (1 << kDoublings);

/// For 0 <= depth <= kModerate, to 4e-7 relative, in half the time of AnyAbsorption(). Computes an eighth of
/// the slab by ThinMean() and doubles it: two slabs of opacity a have opacity (2 - a) a.
template <class D, class V = WideVec<D>>
HWY_INLINE Absorption<V> ModerateAbsorption(D d, V depth) {
  constexpr float kPart = 1.0f / (1 << kDoublings);
  const auto mean_of_part = ThinMean(d, Mul(Set(d, kPart), depth));
  Absorption<V> slab;
  slab.mean = Mul(Set(d, kPart), mean_of_part);
  slab.absorbed = Mul(depth, slab.mean);
  for (int n = 0; n < kDoublings; ++n) {
    const auto of_two = Sub(Set(d, 2.0f), slab.absorbed);
    slab.absorbed = Mul(slab.absorbed, of_two);
    slab.mean = Mul(slab.mean, of_two);
  }
  return slab;
}

/// For any depth >= 0.
template <class D, class V = WideVec<D>>
HWY_INLINE Absorption<V> AnyAbsorption(D d, V depth) {
  const auto absorbed = Absorbed(d, depth);
  const auto thin = Le(depth, Set(d, kThin));
  return {absorbed, IfThenElse(thin, ThinMean(d, depth), Div(absorbed, depth))};
}

}  // namespace splatlas::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // SPLATLAS_PLAYER_ABSORPTION_INL_H_
