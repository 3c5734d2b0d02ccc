// Weighted sums of optical properties. Compiled once for every instruction set.
#if defined(SPLATLAS_PLAYER_MIX_OPTICS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SPLATLAS_PLAYER_MIX_OPTICS_INL_H_
#undef SPLATLAS_PLAYER_MIX_OPTICS_INL_H_
#else
#define SPLATLAS_PLAYER_MIX_OPTICS_INL_H_
#endif

#include <cstddef>

#include <hwy/highway.h>

#include "player/render/sheets/splat/splat_kernels.h"
#include "player/render/simd/wide_vector-inl.h"

HWY_BEFORE_NAMESPACE();
namespace splatlas::HWY_NAMESPACE {

inline void MixOptics(const WeightedOptics& a, const WeightedOptics& b, std::size_t floats, float* mixed) {
  using Tag = NativeTag<WideTag<float, kBlock>>;
  const Tag d;
  const auto weight_a = Set(d, a.weight), weight_b = Set(d, b.weight);
  if (a.optics == nullptr || b.optics == nullptr) {
    const float* const optics = a.optics != nullptr ? a.optics : b.optics;
    const auto weight = a.optics != nullptr ? weight_a : weight_b;
    for (std::size_t n = 0; n < floats; n += kLanesOf<Tag>)
      Store(Mul(weight, Load(d, optics + n)), d, mixed + n);
    return;
  }
  for (std::size_t n = 0; n < floats; n += kLanesOf<Tag>) {
    const auto of_a = Mul(weight_a, Load(d, a.optics + n));
    Store(FusedMulAdd(d, weight_b, Load(d, b.optics + n), of_a), d, mixed + n);
  }
}

}  // namespace splatlas::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // SPLATLAS_PLAYER_MIX_OPTICS_INL_H_
