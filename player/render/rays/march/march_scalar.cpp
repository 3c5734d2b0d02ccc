// Scalar reference kernel of ray marching: the kernel on vectors of one lane, without instruction sets.
#undef HWY_COMPILE_ONLY_STATIC  // of sanitizer presets
#define HWY_COMPILE_ONLY_SCALAR
#include <hwy/highway.h>

#include "player/render/rays/march/march_traversal-inl.h"
#include "player/render/rays/march_kernels.h"

namespace splatlas {

MarchKernels scalar_march() {
  return {"scalar", HWY_NAMESPACE::MarchPacket};
}

}  // namespace splatlas
