#include "player/frame/ray_volume_store.h"

#include <utility>

#include "format/system/result_macros.h"

namespace splatlas {

bool RayVolumeStore::holds(Classification classification, bool shade) const {
  return held_ && held_->classification == classification && held_->shaded == shade;
}

Result<void> RayVolumeStore::build(const RayVolumeRequest& request, ThreadPool& pool) {
  held_.reset();
  SPLATLAS_ASSIGN_OR_RETURN(RayVolume volume, RayVolume::build(request, pool));
  held_ = Held{std::move(volume), request.classification, request.shade, request.runs.count()};
  return {};
}

void RayVolumeStore::light(const ParallelView& view, const Lighting& lighting, ThreadPool& pool) {
  if (!held_->shaded || !held_->volume.shaded()) return;
  if (held_->lit_for && have_same_lighting(*held_->lit_for, view)) return;
  held_->lit_for.reset();
  held_->volume.shade(lighting.table(), pool);
  held_->lit_for = view;
}

}  // namespace splatlas
