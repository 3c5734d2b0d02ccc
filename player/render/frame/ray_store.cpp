#include "player/render/frame/ray_store.h"

#include "format/result_macros.h"

namespace splatlas {

Result<void> RayStore::require(const RenderOptions& options, const Atlas& atlas, const DrawnSelection& drawn,
                               const ClassCache& cache, std::uint64_t max_memory_bytes, ThreadPool& pool) {
  const bool is_built = fits(options);
  if (is_built && (!options.ids || volume_->numbers() != nullptr)) return {};
  const SelectedRuns runs(drawn.plan(), atlas.classes(), cache, Axis::kZ);
  if (is_built) return volume_->number(runs, drawn.numbers(), pool);
  clear();
  SPLATLAS_ASSIGN_OR_RETURN(volume_, RayVolume::build({.atlas = atlas,
                                                       .selection = drawn.selection(),
                                                       .plan = drawn.plan(),
                                                       .appearances = drawn.appearances().appearances(),
                                                       .runs = runs,
                                                       .cache = cache,
                                                       .classification = options.classification,
                                                       .shade = options.hybrid_shading,
                                                       .max_memory_bytes = max_memory_bytes},
                                                      pool));
  return options.ids ? volume_->number(runs, drawn.numbers(), pool) : Result<void>();
}

}  // namespace splatlas
