// Ray marching kernel for every instruction set: Highway compiles this file once for each.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "player/render/rays/march/march_simd.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include <hwy/highway.h>

#include "player/render/rays/march_kernels.h"
#if HWY_TARGET != HWY_SCALAR
#include "player/render/rays/march/march_traversal-inl.h"
#endif

HWY_BEFORE_NAMESPACE();
namespace splatlas::HWY_NAMESPACE {

void MarchDispatched(const MarchScene& scene, const RayPacket& packet, RadiancePacket& radiance) {
#if HWY_TARGET == HWY_SCALAR
  scalar_march().march(scene, packet, radiance);
#else
  MarchPacket(scene, packet, radiance);
#endif
}

}  // namespace splatlas::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "player/render/simd/simd_choice.h"

namespace splatlas {

HWY_EXPORT(MarchDispatched);

MarchKernels best_march() {
  if (scalar_is_forced()) return scalar_march();
  return {best_target(), HWY_DYNAMIC_DISPATCH(MarchDispatched)};
}

}  // namespace splatlas
#endif  // HWY_ONCE
