// Splat kernels of cut slabs for every instruction set: Highway compiles this file once for each.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "player/render/sheets/splat/splat_cut_simd.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include <hwy/highway.h>

#include "player/render/sheets/splat/splat_kernels.h"
#if HWY_TARGET != HWY_SCALAR
#include "player/render/sheets/splat/splat_cut-inl.h"
#endif

HWY_BEFORE_NAMESPACE();
namespace splatlas::HWY_NAMESPACE {

void CompositeCutDispatched(const SheetRows& rows, const ClipRows& kept, float slab_mm,
                            float termination_threshold, const ImageRows& image) {
#if HWY_TARGET == HWY_SCALAR
  scalar_kernels().composite_cut(rows, kept, slab_mm, termination_threshold, image);
#else
  CompositeCutRows(rows, kept, slab_mm, termination_threshold, image);
#endif
}

}  // namespace splatlas::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace splatlas {
namespace {

HWY_EXPORT(CompositeCutDispatched);

}  // namespace

void best_composite_cut(const SheetRows& rows, const ClipRows& kept, float slab_mm,
                        float termination_threshold, const ImageRows& image) {
  HWY_DYNAMIC_DISPATCH(CompositeCutDispatched)(rows, kept, slab_mm, termination_threshold, image);
}

}  // namespace splatlas
#endif  // HWY_ONCE
