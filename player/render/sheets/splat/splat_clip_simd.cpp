// Splat kernels of clipped slabs for every instruction set, apart from splat_simd.cpp to compile in parallel.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "player/render/sheets/splat/splat_clip_simd.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include <hwy/highway.h>

#if HWY_TARGET != HWY_SCALAR
#include "player/render/sheets/splat/splat_rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace splatlas::HWY_NAMESPACE {

template void CompositeClipped(const SheetRows&, const PixelClip&, float, float, const ImageRows&);

}  // namespace splatlas::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
