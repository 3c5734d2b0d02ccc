// Vectors as plain arrays: the operations of Highway that kernels use, lane by lane, for scalar references.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace splatlas::N_SCALAR {

template <typename Lane, std::size_t kCount>
struct ScalarTag {
  using T = Lane;
  static constexpr std::size_t kLanes = kCount;
};

template <typename T, std::size_t kLanes>
struct ScalarVec {
  T lane[kLanes];
};

namespace detail {

/// make(n) for every lane n.
template <typename T, std::size_t kLanes, typename Make>
inline ScalarVec<T, kLanes> per_lane(const Make& make) {
  ScalarVec<T, kLanes> v;
  for (std::size_t n = 0; n < kLanes; ++n) v.lane[n] = make(n);
  return v;
}

}  // namespace detail

#define SPLATLAS_SCALAR_1(Name, T, Result, expression)                     \
  template <typename T, std::size_t kLanes>                                \
  inline ScalarVec<Result, kLanes> Name(const ScalarVec<T, kLanes>& va) {  \
    return detail::per_lane<Result, kLanes>([&](std::size_t n) -> Result { \
      const T a = va.lane[n];                                              \
      return expression;                                                   \
    });                                                                    \
  }
#define SPLATLAS_SCALAR_2(Name, T, Result, expression)                                                    \
  template <typename T, std::size_t kLanes>                                                               \
  inline ScalarVec<Result, kLanes> Name(const ScalarVec<T, kLanes>& va, const ScalarVec<T, kLanes>& vb) { \
    return detail::per_lane<Result, kLanes>([&](std::size_t n) -> Result {                                \
      const T a = va.lane[n], b = vb.lane[n];                                                             \
      return expression;                                                                                  \
    });                                                                                                   \
  }
SPLATLAS_SCALAR_1(Abs, T, T, std::abs(a))
SPLATLAS_SCALAR_1(Ceil, T, T, std::ceil(a))
SPLATLAS_SCALAR_1(Floor, T, T, std::floor(a))
SPLATLAS_SCALAR_1(Neg, T, T, -a)
SPLATLAS_SCALAR_1(Not, T, T, !a)
SPLATLAS_SCALAR_1(Round, T, T, std::nearbyint(a))
SPLATLAS_SCALAR_1(MaskFromVec, T, bool, a != 0)
SPLATLAS_SCALAR_2(Add, T, T, a + b)
SPLATLAS_SCALAR_2(And, T, T, a& b)
SPLATLAS_SCALAR_2(AndNot, T, T, !a & b)
SPLATLAS_SCALAR_2(Div, T, T, a / b)
SPLATLAS_SCALAR_2(Mul, T, T, a* b)
SPLATLAS_SCALAR_2(Or, T, T, a | b)
SPLATLAS_SCALAR_2(Sub, T, T, a - b)
SPLATLAS_SCALAR_2(Max, T, T, a > b ? a : b)
SPLATLAS_SCALAR_2(Min, T, T, a < b ? a : b)
SPLATLAS_SCALAR_2(Eq, T, bool, a == b)
SPLATLAS_SCALAR_2(Ge, T, bool, a >= b)
SPLATLAS_SCALAR_2(Gt, T, bool, a > b)
SPLATLAS_SCALAR_2(Le, T, bool, a <= b)
SPLATLAS_SCALAR_2(Lt, T, bool, a < b)
#undef SPLATLAS_SCALAR_1
#undef SPLATLAS_SCALAR_2

template <typename T, std::size_t kLanes>
inline ScalarVec<T, kLanes> IfThenElse(const ScalarVec<bool, kLanes>& mask, const ScalarVec<T, kLanes>& yes,
                                       const ScalarVec<T, kLanes>& no) {
  return detail::per_lane<T, kLanes>([&](std::size_t n) { return mask.lane[n] ? yes.lane[n] : no.lane[n]; });
}
template <typename T, std::size_t kLanes>
inline ScalarVec<T, kLanes> IfThenZeroElse(const ScalarVec<bool, kLanes>& mask,
                                           const ScalarVec<T, kLanes>& no) {
  return detail::per_lane<T, kLanes>([&](std::size_t n) { return mask.lane[n] ? T{0} : no.lane[n]; });
}
/// factor * x + addend, rounded once.
template <std::size_t kLanes>
inline ScalarVec<float, kLanes> MulAdd(const ScalarVec<float, kLanes>& factor,
                                       const ScalarVec<float, kLanes>& x,
                                       const ScalarVec<float, kLanes>& addend) {
  return detail::per_lane<float, kLanes>(
      [&](std::size_t n) { return std::fma(factor.lane[n], x.lane[n], addend.lane[n]); });
}
template <std::size_t kLanes>
inline ScalarVec<float, kLanes> FusedMulAdd(ScalarTag<float, kLanes>, const ScalarVec<float, kLanes>& factor,
                                            const ScalarVec<float, kLanes>& x,
                                            const ScalarVec<float, kLanes>& addend) {
  return MulAdd(factor, x, addend);
}
/// factor * x - subtrahend, rounded once.
template <std::size_t kLanes>
inline ScalarVec<float, kLanes> FusedMulSub(ScalarTag<float, kLanes>, const ScalarVec<float, kLanes>& factor,
                                            const ScalarVec<float, kLanes>& x,
                                            const ScalarVec<float, kLanes>& subtrahend) {
  return MulAdd(factor, x, Neg(subtrahend));
}
template <std::size_t kLanes>
inline ScalarVec<float, kLanes> NegMulAdd(const ScalarVec<float, kLanes>& factor,
                                          const ScalarVec<float, kLanes>& x,
                                          const ScalarVec<float, kLanes>& addend) {
  return MulAdd(Neg(factor), x, addend);
}
template <std::size_t kLanes>
inline ScalarVec<float, kLanes> FusedNegMulAdd(ScalarTag<float, kLanes>,
                                               const ScalarVec<float, kLanes>& factor,
                                               const ScalarVec<float, kLanes>& x,
                                               const ScalarVec<float, kLanes>& addend) {
  return NegMulAdd(factor, x, addend);
}
template <int kBits, typename T, std::size_t kLanes>
inline ScalarVec<T, kLanes> ShiftBitsLeft(const ScalarVec<T, kLanes>& v) {
  return detail::per_lane<T, kLanes>([&](std::size_t n) { return v.lane[n] << kBits; });
}
template <int kBits, typename T, std::size_t kLanes>
inline ScalarVec<T, kLanes> ShiftBitsRight(const ScalarVec<T, kLanes>& v) {
  return detail::per_lane<T, kLanes>([&](std::size_t n) { return v.lane[n] >> kBits; });
}

/// Lane 0 of `first`, the others of `rest`.
template <typename T, std::size_t kLanes>
inline ScalarVec<T, kLanes> WithFirstLane(const ScalarVec<T, kLanes>& first,
                                          const ScalarVec<T, kLanes>& rest) {
  return detail::per_lane<T, kLanes>([&](std::size_t n) { return n == 0 ? first.lane[0] : rest.lane[n]; });
}
/// Rotates lanes upwards by one: the last lane becomes lane 0.
template <typename T, std::size_t kLanes>
inline ScalarVec<T, kLanes> Rotated(const ScalarVec<T, kLanes>& v) {
  return detail::per_lane<T, kLanes>([&](std::size_t n) { return v.lane[(n + kLanes - 1) % kLanes]; });
}

template <typename T, std::size_t kLanes, typename Value>
inline ScalarVec<T, kLanes> Set(ScalarTag<T, kLanes>, Value value) {
  return detail::per_lane<T, kLanes>([&](std::size_t) { return static_cast<T>(value); });
}
template <typename T, std::size_t kLanes>
inline ScalarVec<T, kLanes> Zero(ScalarTag<T, kLanes>) {
  return {};
}
template <typename T, std::size_t kLanes>
inline ScalarVec<T, kLanes> Load(ScalarTag<T, kLanes>, const T* values) {
  return detail::per_lane<T, kLanes>([&](std::size_t n) { return values[n]; });
}
template <typename T, std::size_t kLanes>
inline ScalarVec<T, kLanes> LoadU(ScalarTag<T, kLanes> tag, const T* values) {
  return Load(tag, values);
}
template <typename T, std::size_t kLanes>
inline void Store(const ScalarVec<T, kLanes>& v, ScalarTag<T, kLanes>, T* values) {
  std::copy_n(v.lane, kLanes, values);
}
template <typename T, std::size_t kLanes>
inline void StoreU(const ScalarVec<T, kLanes>& v, ScalarTag<T, kLanes> tag, T* values) {
  Store(v, tag, values);
}
template <typename T, std::size_t kLanes>
inline ScalarVec<T, kLanes> GatherIndex(ScalarTag<T, kLanes>, const T* values,
                                        const ScalarVec<std::int32_t, kLanes>& indices) {
  return detail::per_lane<T, kLanes>([&](std::size_t n) { return values[indices.lane[n]]; });
}
/// Between floats and integers: truncates.
template <typename T, typename From, std::size_t kLanes>
inline ScalarVec<T, kLanes> ConvertTo(ScalarTag<T, kLanes>, const ScalarVec<From, kLanes>& v) {
  return detail::per_lane<T, kLanes>([&](std::size_t n) { return static_cast<T>(v.lane[n]); });
}
template <typename T, typename From, std::size_t kLanes>
inline ScalarVec<T, kLanes> BitCast(ScalarTag<T, kLanes>, const ScalarVec<From, kLanes>& v) {
  return detail::per_lane<T, kLanes>([&](std::size_t n) { return std::bit_cast<T>(v.lane[n]); });
}
template <typename T, std::size_t kLanes>
inline ScalarVec<bool, kLanes> RebindMask(ScalarTag<T, kLanes>, const ScalarVec<bool, kLanes>& mask) {
  return mask;
}
template <typename T, std::size_t kLanes>
inline ScalarVec<T, kLanes> VecFromMask(ScalarTag<T, kLanes>, const ScalarVec<bool, kLanes>& mask) {
  return detail::per_lane<T, kLanes>([&](std::size_t n) { return mask.lane[n] ? T{-1} : T{0}; });
}
/// Element n of each of four vectors, for every n: values[4 * n] to values[4 * n + 3].
template <typename T, std::size_t kLanes>
inline void LoadInterleaved4(ScalarTag<T, kLanes>, const T* values, ScalarVec<T, kLanes>& a,
                             ScalarVec<T, kLanes>& b, ScalarVec<T, kLanes>& c, ScalarVec<T, kLanes>& d) {
  for (std::size_t n = 0; n < kLanes; ++n) {
    a.lane[n] = values[4 * n];
    b.lane[n] = values[4 * n + 1];
    c.lane[n] = values[4 * n + 2];
    d.lane[n] = values[4 * n + 3];
  }
}

template <typename T, std::size_t kLanes>
inline bool AllTrue(ScalarTag<T, kLanes>, const ScalarVec<bool, kLanes>& mask) {
  return std::all_of(mask.lane, mask.lane + kLanes, [](bool lane) { return lane; });
}
template <typename T, std::size_t kLanes>
inline bool AllFalse(ScalarTag<T, kLanes>, const ScalarVec<bool, kLanes>& mask) {
  return std::none_of(mask.lane, mask.lane + kLanes, [](bool lane) { return lane; });
}
template <std::size_t kLanes>
inline float MinLane(ScalarTag<float, kLanes>, const ScalarVec<float, kLanes>& v) {
  return *std::min_element(v.lane, v.lane + kLanes);
}
template <std::size_t kLanes>
inline float MaxLane(ScalarTag<float, kLanes>, const ScalarVec<float, kLanes>& v) {
  return *std::max_element(v.lane, v.lane + kLanes);
}

}  // namespace splatlas::N_SCALAR
