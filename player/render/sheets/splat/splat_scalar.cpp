// Scalar reference of the splat kernels: the kernels on plain arrays, without instruction sets.
#undef HWY_COMPILE_ONLY_STATIC  // of sanitizer presets
#define HWY_COMPILE_ONLY_SCALAR
#include <hwy/highway.h>

#include "player/render/sheets/splat/splat_kernels.h"
#include "player/render/sheets/splat/splat_rows-inl.h"

namespace splatlas {

SplatKernels scalar_kernels() {
  return {"scalar", HWY_NAMESPACE::CompositeRows, HWY_NAMESPACE::MixOptics};
}

}  // namespace splatlas
