// Linked instead of the kernel of ray casting.
#include "player/render/rays/march_kernels.h"
#include "player/web/ray_casting.h"

namespace splatlas {

bool has_ray_casting() {
  return false;
}

const MarchKernels& best_march() {
  static constexpr MarchKernels kNone{"none", nullptr};  // sheets draw instead; the API refuses perspective
  return kNone;
}
const MarchKernels& scalar_march() {
  return best_march();
}

}  // namespace splatlas
