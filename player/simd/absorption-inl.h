// What a slab of some depth absorbs. Compiled once for every instruction set.
#if defined(SPLATLAS_PLAYER_ABSORPTION_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SPLATLAS_PLAYER_ABSORPTION_INL_H_
#undef SPLATLAS_PLAYER_ABSORPTION_INL_H_
#else
#define SPLATLAS_PLAYER_ABSORPTION_INL_H_
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace splatlas::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Slabs of at most this depth take the short way: ThinMean().
constexpr float kThin = 0.75f;

/// (1 - exp(-depth)) / depth, 0 <= depth <= kThin, to 1.5e-7 relative: 1 - depth / 2 + ..., the rest
/// through the Chebyshev nodes of that range.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V ThinMean(D d, V depth) {
  auto mean = hn::Set(d, -1.067719662e-03f);
  mean = hn::MulAdd(mean, depth, hn::Set(d, 8.132654303e-03f));
  mean = hn::MulAdd(mean, depth, hn::Set(d, -4.161409106e-02f));
  mean = hn::MulAdd(mean, depth, hn::Set(d, 1.666617870e-01f));
  mean = hn::MulAdd(mean, depth, hn::Set(d, -4.999999269e-01f));
  return hn::MulAdd(mean, depth, hn::Set(d, 1.0f));
}

/// 1 - exp(-depth) for depth >= 0 to about 1e-7 relative: exp(-depth) = 2^n * (1 + r * q(r)) with |r| <=
/// ln(2) / 2, so that the difference from 1 never cancels for small depths.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V Absorbed(D d, V depth) {
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
  const hn::RebindToSigned<D> di;
  const auto bits = hn::ShiftLeft<23>(hn::Add(hn::ConvertTo(di, n), hn::Set(di, 127)));
  const auto scale = hn::BitCast(d, bits);
  return hn::NegMulAdd(scale, hn::Mul(r, q), hn::Sub(one, scale));
}

/// What a slab absorbs of the light, 1 - exp(-depth), and the same over its depth.
template <class V>
struct Absorption {
  V absorbed, mean;
};

constexpr int kDoublings = 3;
/// Slabs of at most this depth take the middle way: ModerateAbsorption().
constexpr float kModerate = kThin * (1 << kDoublings);

/// For 0 <= depth <= kModerate, to 4e-7 relative, in half the time of AnyAbsorption(): an eighth of the slab
/// takes the short way and is doubled. Two slabs that absorb a each absorb (2 - a) a.
template <class D, class V = hn::Vec<D>>
HWY_INLINE Absorption<V> ModerateAbsorption(D d, V depth) {
  constexpr float kPart = 1.0f / (1 << kDoublings);
  const auto mean_of_part = ThinMean(d, hn::Mul(hn::Set(d, kPart), depth));
  Absorption<V> slab;
  slab.mean = hn::Mul(hn::Set(d, kPart), mean_of_part);
  slab.absorbed = hn::Mul(depth, slab.mean);
  for (int n = 0; n < kDoublings; ++n) {
    const auto of_two = hn::Sub(hn::Set(d, 2.0f), slab.absorbed);
    slab.absorbed = hn::Mul(slab.absorbed, of_two);
    slab.mean = hn::Mul(slab.mean, of_two);
  }
  return slab;
}

/// For depth >= 0, whatever it is.
template <class D, class V = hn::Vec<D>>
HWY_INLINE Absorption<V> AnyAbsorption(D d, V depth) {
  const auto absorbed = Absorbed(d, depth);
  const auto thin = hn::Le(depth, hn::Set(d, kThin));
  return {absorbed, hn::IfThenElse(thin, ThinMean(d, depth), hn::Div(absorbed, depth))};
}

}  // namespace splatlas::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // SPLATLAS_PLAYER_ABSORPTION_INL_H_
