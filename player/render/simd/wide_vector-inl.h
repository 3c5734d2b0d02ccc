// Vectors of a fixed number of lanes, made of native vectors. Compiled once for every instruction set.
#if defined(SPLATLAS_PLAYER_WIDE_VECTOR_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SPLATLAS_PLAYER_WIDE_VECTOR_INL_H_
#undef SPLATLAS_PLAYER_WIDE_VECTOR_INL_H_
#else
#define SPLATLAS_PLAYER_WIDE_VECTOR_INL_H_
#endif

#include <cmath>
#include <cstddef>
#include <cstdint>

#include <hwy/highway.h>

// A wide vector is a native vector where one has enough lanes, else a pair of vectors of half the lanes:
// native vectors of the scalar reference have one lane. Code calls the operations of Highway without `hn::`:
// argument-dependent lookup finds Highway's own or those below. Results have the same bits on every
// instruction set: multiplications and additions round as written (files that include this header are
// compiled with -ffp-contract=off), and MulAdd of pairs and FusedMulAdd of any vector round once everywhere.
// Highway's MulAdd of native vectors rounds twice on SSE.

HWY_BEFORE_NAMESPACE();
namespace splatlas::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

namespace detail {

template <class D>
struct TagTraits {
  static constexpr std::size_t kLanes = hn::MaxLanes(D());
  using Signed = hn::RebindToSigned<D>;
  using Unsigned = hn::RebindToUnsigned<D>;
  using Vector = hn::Vec<D>;
  using Mask = hn::Mask<D>;
};

template <class D>
struct NativeTagOf {
  using type = D;
};

}  // namespace detail

/// Tag of the native vectors that a wide vector is made of; in the scalar reference, its own.
template <class D>
using NativeTag = typename detail::NativeTagOf<D>::type;

template <class D>
using SignedTag = typename detail::TagTraits<D>::Signed;
template <class D>
using UnsignedTag = typename detail::TagTraits<D>::Unsigned;
template <class D>
using WideVec = typename detail::TagTraits<D>::Vector;
template <class D>
using WideMask = typename detail::TagTraits<D>::Mask;
template <class D>
inline constexpr std::size_t kLanesOf = detail::TagTraits<D>::kLanes;

template <int kBits, class V>
HWY_INLINE V ShiftBitsLeft(V v) {
  return hn::ShiftLeft<kBits>(v);
}
template <int kBits, class V>
HWY_INLINE V ShiftBitsRight(V v) {
  return hn::ShiftRight<kBits>(v);
}

template <class V>
struct Pair {
  V low, high;
};
template <class V>
HWY_INLINE Pair<V> MakePair(V low, V high) {
  return {low, high};
}

template <class D>
struct PairTag {};

namespace detail {

#if HWY_TARGET != HWY_SCALAR
template <class D>
struct NativeTagOf<PairTag<D>> : NativeTagOf<D> {};
#endif

template <class D>
struct TagTraits<PairTag<D>> {
  using Half = TagTraits<D>;
  static constexpr std::size_t kLanes = 2 * Half::kLanes;
  using Signed = PairTag<typename Half::Signed>;
  using Unsigned = PairTag<typename Half::Unsigned>;
  using Vector = Pair<typename Half::Vector>;
  using Mask = Pair<typename Half::Mask>;
};

template <typename T, std::size_t kLanes, std::size_t kNative>
struct WideTagOf {
  using type = PairTag<typename WideTagOf<T, kLanes / 2, kNative>::type>;
};
template <typename T, std::size_t kLanes>
struct WideTagOf<T, kLanes, kLanes> {
  using type = hn::CappedTag<T, kLanes>;
};

}  // namespace detail

/// Tag of a vector of exactly `kLanes` lanes of T.
template <typename T, std::size_t kLanes>
using WideTag = typename detail::WideTagOf<T, kLanes, hn::MaxLanes(hn::CappedTag<T, kLanes>())>::type;
// Arithmetic, comparisons and masks, half by half.
#define SPLATLAS_WIDE_1(Name)                   \
  template <class V>                            \
  HWY_INLINE auto Name(const Pair<V>& a) {      \
    return MakePair(Name(a.low), Name(a.high)); \
  }
#define SPLATLAS_WIDE_2(Name)                                  \
  template <class V>                                           \
  HWY_INLINE auto Name(const Pair<V>& a, const Pair<V>& b) {   \
    return MakePair(Name(a.low, b.low), Name(a.high, b.high)); \
  }
#define SPLATLAS_WIDE_MASKED(Name)                                 \
  template <class M, class V>                                      \
  HWY_INLINE Pair<V> Name(const Pair<M>& mask, const Pair<V>& a) { \
    return {Name(mask.low, a.low), Name(mask.high, a.high)};       \
  }
SPLATLAS_WIDE_1(Abs)
SPLATLAS_WIDE_1(Ceil)
SPLATLAS_WIDE_1(Floor)
SPLATLAS_WIDE_1(Neg)
SPLATLAS_WIDE_1(Not)
SPLATLAS_WIDE_1(Round)
SPLATLAS_WIDE_1(MaskFromVec)
SPLATLAS_WIDE_2(Add)
SPLATLAS_WIDE_2(And)
SPLATLAS_WIDE_2(AndNot)
SPLATLAS_WIDE_2(Div)
SPLATLAS_WIDE_2(Eq)
SPLATLAS_WIDE_2(Ge)
SPLATLAS_WIDE_2(Gt)
SPLATLAS_WIDE_2(Le)
SPLATLAS_WIDE_2(Lt)
SPLATLAS_WIDE_2(Max)
SPLATLAS_WIDE_2(Min)
SPLATLAS_WIDE_2(Mul)
SPLATLAS_WIDE_2(Or)
SPLATLAS_WIDE_2(Sub)
SPLATLAS_WIDE_MASKED(IfThenZeroElse)
#undef SPLATLAS_WIDE_1
#undef SPLATLAS_WIDE_2
#undef SPLATLAS_WIDE_MASKED

template <class M, class V>
HWY_INLINE Pair<V> IfThenElse(const Pair<M>& mask, const Pair<V>& yes, const Pair<V>& no) {
  return {IfThenElse(mask.low, yes.low, no.low), IfThenElse(mask.high, yes.high, no.high)};
}
template <int kBits, class V>
HWY_INLINE Pair<V> ShiftBitsLeft(const Pair<V>& v) {
  return {ShiftBitsLeft<kBits>(v.low), ShiftBitsLeft<kBits>(v.high)};
}
template <int kBits, class V>
HWY_INLINE Pair<V> ShiftBitsRight(const Pair<V>& v) {
  return {ShiftBitsRight<kBits>(v.low), ShiftBitsRight<kBits>(v.high)};
}

#if HWY_TARGET == HWY_SCALAR || HWY_TARGET == HWY_SSE4

#if HWY_TARGET == HWY_SCALAR
template <class D>
HWY_INLINE hn::Vec<D> FusedMulAdd(D, hn::Vec<D> factor, hn::Vec<D> x, hn::Vec<D> addend) {
  return hn::Vec<D>(std::fma(factor.raw, x.raw, addend.raw));
}
#else
/// factor * x + addend, rounded once. There is no instruction for it: double holds the product exactly, so
/// that one result in 2^28 or so is rounded twice.
template <class D>
HWY_INLINE hn::Vec<D> FusedMulAdd(D d, hn::Vec<D> factor, hn::Vec<D> x, hn::Vec<D> addend) {
  const hn::Half<D> half;
  const hn::Rebind<double, decltype(half)> wide;
  const auto lower = hn::Add(
      hn::Mul(hn::PromoteTo(wide, hn::LowerHalf(half, factor)), hn::PromoteTo(wide, hn::LowerHalf(half, x))),
      hn::PromoteTo(wide, hn::LowerHalf(half, addend)));
  const auto upper = hn::Add(
      hn::Mul(hn::PromoteTo(wide, hn::UpperHalf(half, factor)), hn::PromoteTo(wide, hn::UpperHalf(half, x))),
      hn::PromoteTo(wide, hn::UpperHalf(half, addend)));
  return hn::Combine(d, hn::DemoteTo(half, upper), hn::DemoteTo(half, lower));
}
#endif
template <class D>
HWY_INLINE hn::Vec<D> FusedMulSub(D d, hn::Vec<D> factor, hn::Vec<D> x, hn::Vec<D> subtrahend) {
  return FusedMulAdd(d, factor, x, hn::Neg(subtrahend));
}
template <class D>
HWY_INLINE hn::Vec<D> FusedNegMulAdd(D d, hn::Vec<D> factor, hn::Vec<D> x, hn::Vec<D> addend) {
  return FusedMulAdd(d, hn::Neg(factor), x, addend);
}

#else

/// factor * x + addend, rounded once.
template <class D>
HWY_INLINE hn::Vec<D> FusedMulAdd(D, hn::Vec<D> factor, hn::Vec<D> x, hn::Vec<D> addend) {
  return hn::MulAdd(factor, x, addend);
}
/// factor * x - subtrahend, rounded once.
template <class D>
HWY_INLINE hn::Vec<D> FusedMulSub(D, hn::Vec<D> factor, hn::Vec<D> x, hn::Vec<D> subtrahend) {
  return hn::MulSub(factor, x, subtrahend);
}
/// addend - factor * x, rounded once.
template <class D>
HWY_INLINE hn::Vec<D> FusedNegMulAdd(D, hn::Vec<D> factor, hn::Vec<D> x, hn::Vec<D> addend) {
  return hn::NegMulAdd(factor, x, addend);
}

#endif

#define SPLATLAS_WIDE_FUSED(Name)                                                             \
  template <class D, class V>                                                                 \
  HWY_INLINE Pair<V> Name(PairTag<D>, const Pair<V>& a, const Pair<V>& b, const Pair<V>& c) { \
    return {Name(D(), a.low, b.low, c.low), Name(D(), a.high, b.high, c.high)};               \
  }
SPLATLAS_WIDE_FUSED(FusedMulAdd)
SPLATLAS_WIDE_FUSED(FusedMulSub)
SPLATLAS_WIDE_FUSED(FusedNegMulAdd)
#undef SPLATLAS_WIDE_FUSED

namespace detail {

template <class V>
struct TagOfVector {
  using type = hn::DFromV<V>;
};
template <class V>
struct TagOfVector<Pair<V>> {
  using type = PairTag<typename TagOfVector<V>::type>;
};

}  // namespace detail

template <class V>
HWY_INLINE Pair<V> MulAdd(const Pair<V>& factor, const Pair<V>& x, const Pair<V>& addend) {
  return FusedMulAdd(typename detail::TagOfVector<Pair<V>>::type(), factor, x, addend);
}
template <class V>
HWY_INLINE Pair<V> NegMulAdd(const Pair<V>& factor, const Pair<V>& x, const Pair<V>& addend) {
  return FusedNegMulAdd(typename detail::TagOfVector<Pair<V>>::type(), factor, x, addend);
}

// Memory and conversions.
template <class D, typename T>
HWY_INLINE WideVec<PairTag<D>> Set(PairTag<D>, T value) {
  return {Set(D(), value), Set(D(), value)};
}
template <class D>
HWY_INLINE WideVec<PairTag<D>> Zero(PairTag<D>) {
  return {Zero(D()), Zero(D())};
}
template <class D, typename T, class V>
HWY_INLINE WideVec<PairTag<D>> GatherIndex(PairTag<D>, const T* values, const Pair<V>& indices) {
  return {GatherIndex(D(), values, indices.low), GatherIndex(D(), values, indices.high)};
}
#define SPLATLAS_WIDE_LOAD(Name)                                     \
  template <class D, typename T>                                     \
  HWY_INLINE WideVec<PairTag<D>> Name(PairTag<D>, const T* values) { \
    return {Name(D(), values), Name(D(), values + kLanesOf<D>)};     \
  }
#define SPLATLAS_WIDE_STORE(Name)                                 \
  template <class V, class D, typename T>                         \
  HWY_INLINE void Name(const Pair<V>& v, PairTag<D>, T* values) { \
    Name(v.low, D(), values);                                     \
    Name(v.high, D(), values + kLanesOf<D>);                      \
  }
#define SPLATLAS_WIDE_CONVERT(Result, Name)                          \
  template <class D, class V>                                        \
  HWY_INLINE Result<PairTag<D>> Name(PairTag<D>, const Pair<V>& v) { \
    return {Name(D(), v.low), Name(D(), v.high)};                    \
  }
SPLATLAS_WIDE_LOAD(Load)
SPLATLAS_WIDE_LOAD(LoadU)
SPLATLAS_WIDE_STORE(Store)
SPLATLAS_WIDE_STORE(StoreU)
SPLATLAS_WIDE_CONVERT(WideVec, BitCast)
SPLATLAS_WIDE_CONVERT(WideVec, ConvertTo)
SPLATLAS_WIDE_CONVERT(WideMask, RebindMask)
SPLATLAS_WIDE_CONVERT(WideVec, VecFromMask)
#undef SPLATLAS_WIDE_LOAD
#undef SPLATLAS_WIDE_STORE
#undef SPLATLAS_WIDE_CONVERT

// Shifts between neighbouring lanes.
/// Lane 0 of `first`, the others of `rest`.
template <class V>
HWY_INLINE V WithFirstLane(const V& first, const V& rest) {
#if HWY_TARGET == HWY_WASM
  return V{wasm_i32x4_shuffle(first.raw, rest.raw, 0, 5, 6, 7)};  // one instruction instead of three
#else
  return hn::IfThenElse(hn::FirstN(hn::DFromV<V>(), 1), first, rest);
#endif
}
template <class V>
HWY_INLINE Pair<V> WithFirstLane(const Pair<V>& first, const Pair<V>& rest) {
  return {WithFirstLane(first.low, rest.low), rest.high};
}
/// Rotates lanes upwards by one: the last lane becomes lane 0.
template <class V>
HWY_INLINE V Rotated(const V& v) {
#if HWY_TARGET == HWY_SCALAR
  return v;
#else
  using D = hn::DFromV<V>;
  if constexpr (hn::MaxLanes(D()) == 4) {
    return hn::Shuffle2103(v);  // Highway emulates look-ups on WebAssembly, byte by byte
  } else {
    const hn::RebindToSigned<D> di;
    constexpr auto kLast = static_cast<std::int32_t>(hn::MaxLanes(D()) - 1);
    const auto before = hn::And(hn::Iota(di, kLast), hn::Set(di, kLast));
    return hn::TableLookupLanes(v, hn::IndicesFromVec(D(), before));
  }
#endif
}
template <class V>
HWY_INLINE Pair<V> Rotated(const Pair<V>& v) {
  const auto low = Rotated(v.low), high = Rotated(v.high);
  return {WithFirstLane(high, low), WithFirstLane(low, high)};
}

/// Element n of each of four vectors, for every n: values[4 * n] to values[4 * n + 3].
template <class D, typename T, class V>
HWY_INLINE void LoadInterleaved4(PairTag<D>, const T* values, Pair<V>& a, Pair<V>& b, Pair<V>& c,
                                 Pair<V>& e) {
  LoadInterleaved4(D(), values, a.low, b.low, c.low, e.low);
  LoadInterleaved4(D(), values + 4 * kLanesOf<D>, a.high, b.high, c.high, e.high);
}

// Reductions.
template <class D, class M>
HWY_INLINE bool AllTrue(PairTag<D>, const Pair<M>& mask) {
  return AllTrue(D(), And(mask.low, mask.high));
}
template <class D, class M>
HWY_INLINE bool AllFalse(PairTag<D>, const Pair<M>& mask) {
  return AllFalse(D(), Or(mask.low, mask.high));
}
template <class D>
HWY_INLINE float MinLane(D d, hn::Vec<D> v) {
  return hn::GetLane(hn::MinOfLanes(d, v));
}
template <class D, class V>
HWY_INLINE float MinLane(PairTag<D>, const Pair<V>& v) {
  return MinLane(D(), Min(v.low, v.high));
}
template <class D>
HWY_INLINE float MaxLane(D d, hn::Vec<D> v) {
  return hn::GetLane(hn::MaxOfLanes(d, v));
}
template <class D, class V>
HWY_INLINE float MaxLane(PairTag<D>, const Pair<V>& v) {
  return MaxLane(D(), Max(v.low, v.high));
}

}  // namespace splatlas::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // SPLATLAS_PLAYER_WIDE_VECTOR_INL_H_
