// The kernels once for every instruction set: Highway compiles this file again and again.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "player/splat_simd.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include <cstdint>
#include <cstdlib>
#include <cstring>

#include <hwy/highway.h>

#include "player/splat_kernels.h"

HWY_BEFORE_NAMESPACE();
namespace splatlas::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// At most kSpanPadding lanes, so that padding covers every overrun.
using Lanes = hn::CappedTag<float, 16>;

void Splat(const float* light, std::size_t light_stride, std::size_t count, float weight_here,
           float weight_before, float* row, std::size_t row_stride) {
  const Lanes d;
  const auto here = hn::Set(d, weight_here);
  const auto before = hn::Set(d, weight_before);
  for (std::size_t n = 0; n < count; n += hn::Lanes(d)) {
    for (std::size_t plane = 0; plane < 4; ++plane) {
      const float* from = light + plane * light_stride + n;
      float* to = row + plane * row_stride + n;
      const auto sum = hn::MulAdd(here, hn::LoadU(d, from), hn::LoadU(d, to));
      hn::StoreU(hn::MulAdd(before, hn::LoadU(d, from - 1), sum), d, to);
    }
  }
}

/// 1 - exp(-depth) for depth >= 0 to about 1e-7 relative: exp(-depth) = 2^n * (1 + r * q(r)) with |r| <=
/// ln(2) / 2, so that the difference from 1 never cancels for small depths.
template <class V>
HWY_INLINE V Absorbed(V depth) {
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

void Composite(float* row, std::size_t row_stride, std::size_t count, float slab_mm, float* image,
               std::size_t image_stride) {
  const Lanes d;
  const auto slab = hn::Set(d, slab_mm);
  const auto one = hn::Set(d, 1.0f);
  const auto zero = hn::Zero(d);
  for (std::size_t n = 0; n < count; n += hn::Lanes(d)) {
    const auto extinction = hn::LoadU(d, row + n);
    const auto opacity = hn::LoadU(d, image + 3 * image_stride + n);
    const auto through = hn::Sub(one, opacity);
    const auto depth = hn::Mul(extinction, slab);
    const auto absorbed = Absorbed(depth);
    const auto mean = hn::Div(absorbed, hn::Max(depth, hn::Set(d, 1e-30f)));
    const auto weight = hn::Mul(hn::Mul(through, slab), mean);
    for (std::size_t c = 0; c < 3; ++c) {
      float* color = image + c * image_stride + n;
      const auto emission = hn::LoadU(d, row + (c + 1) * row_stride + n);
      hn::StoreU(hn::MulAdd(weight, emission, hn::LoadU(d, color)), d, color);
      hn::StoreU(zero, d, row + (c + 1) * row_stride + n);
    }
    hn::StoreU(hn::MulAdd(through, absorbed, opacity), d, image + 3 * image_stride + n);
    hn::StoreU(zero, d, row + n);
  }
}

}  // namespace splatlas::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace splatlas {
namespace {

HWY_EXPORT(Splat);
HWY_EXPORT(Composite);

void splat(const float* light, std::size_t light_stride, std::size_t count, float weight_here,
           float weight_before, float* row, std::size_t row_stride) {
  HWY_DYNAMIC_DISPATCH(Splat)(light, light_stride, count, weight_here, weight_before, row, row_stride);
}

void composite(float* row, std::size_t row_stride, std::size_t count, float slab_mm, float* image,
               std::size_t image_stride) {
  HWY_DYNAMIC_DISPATCH(Composite)(row, row_stride, count, slab_mm, image, image_stride);
}

bool scalar_is_forced() {
  const char* forced = std::getenv("SPLATLAS_SIMD");
  return forced != nullptr && std::strcmp(forced, "scalar") == 0;
}

}  // namespace

const SplatKernels& best_kernels() {
  static const SplatKernels kKernels = [] {
    if (scalar_is_forced()) return scalar_kernels();
    const std::int64_t supported = hwy::SupportedTargets();
    return SplatKernels{hwy::TargetName(supported & -supported), splat,
                        composite};  // the best is the lowest bit
  }();
  return kKernels;
}

}  // namespace splatlas
#endif  // HWY_ONCE
