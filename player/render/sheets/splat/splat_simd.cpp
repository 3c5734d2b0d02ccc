// Splat kernels for every instruction set: Highway compiles this file once for each.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "player/render/sheets/splat/splat_simd.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include <hwy/highway.h>

#include "player/render/sheets/splat/splat_kernels.h"
#if HWY_TARGET != HWY_SCALAR
#include "player/render/sheets/splat/splat_rows-inl.h"
#endif

HWY_BEFORE_NAMESPACE();
namespace splatlas::HWY_NAMESPACE {

#if HWY_TARGET != HWY_SCALAR
// In splat_clip_simd.cpp.
extern template void CompositeClipped(const SheetRows&, const PixelClip&, float, float, const ImageRows&);
#endif

void CompositeDispatched(const SheetRows& rows, const ClipRows& clip, float slab_mm, float threshold,
                         const ImageRows& image) {
#if HWY_TARGET == HWY_SCALAR
  scalar_kernels().composite(rows, clip, slab_mm, threshold, image);
#else
  CompositeRows(rows, clip, slab_mm, threshold, image);
#endif
}

void MixDispatched(const WeightedOptics& a, const WeightedOptics& b, std::size_t floats, float* mixed) {
#if HWY_TARGET == HWY_SCALAR
  scalar_kernels().mix(a, b, floats, mixed);
#else
  MixOptics(a, b, floats, mixed);
#endif
}

}  // namespace splatlas::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "player/render/simd/simd_choice.h"

namespace splatlas {

HWY_EXPORT(CompositeDispatched);
HWY_EXPORT(MixDispatched);

SplatKernels best_kernels() {
  if (scalar_is_forced()) return scalar_kernels();
  return {best_target(), HWY_DYNAMIC_DISPATCH(CompositeDispatched), HWY_DYNAMIC_DISPATCH(MixDispatched)};
}

}  // namespace splatlas
#endif  // HWY_ONCE
