#include "player/render/frame/ray_store.h"

#include <utility>

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

bool RayStore::require_blocks(const RenderOptions& options, const std::shared_ptr<const Atlas>& atlas,
                              const DrawnSelection& drawn, std::uint64_t max_memory_bytes, ThreadPool& pool) {
  if (blocks_ && volume_->fits(Classification::kBefore, options.hybrid_shading)) return true;
  clear();
  const auto read = BlockVolume::read(atlas, drawn.plan(), pool);
  if (!read) return false;
  BlockVolume& blocks = **read;
  blocks.require(Axis::kZ, pool);
  VolumeAppearances appearances(*atlas);
  appearances.select(blocks.plan(), drawn.selection());
  const SelectedRuns runs(blocks.plan(), blocks.classes(), blocks.cache(), Axis::kZ);
  auto built = RayVolume::build({.atlas = *atlas,
                                 .selection = drawn.selection(),
                                 .plan = blocks.plan(),
                                 .appearances = appearances.appearances(),
                                 .runs = runs,
                                 .cache = blocks.cache(),
                                 .shade = options.hybrid_shading,
                                 .max_memory_bytes = max_memory_bytes,
                                 .blocks = &blocks},
                                pool);
  if (!built) return false;
  volume_ = std::move(*built);
  blocks_ = blocks.grid();
  return true;
}

}  // namespace splatlas
