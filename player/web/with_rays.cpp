// Linked with the kernel of ray casting.
#include "player/render/rays/march_kernels.h"
#include "player/web/ray_casting.h"

namespace splatlas {

bool has_ray_casting() {
  return true;
}

#ifdef __wasm__
const MarchKernels& scalar_march() {  // the module has one instruction set
  return best_march();
}
#endif

}  // namespace splatlas
