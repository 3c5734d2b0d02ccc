#include "player/render/frame/ray_store.h"

#include <utility>

#include "format/result_macros.h"
#include "player/render/frame/ray_frame.h"
#include "player/render/light/voxel_light.h"

namespace splatlas {

Result<void> RayStore::require(const View& view, const RenderOptions& options, const Atlas& atlas,
                               const DrawnSelection& drawn, const ClassCache& cache,
                               std::uint64_t max_memory_bytes, ThreadPool& pool) {
  const SelectedRuns runs(drawn.plan(), atlas.classes(), cache, Axis::kZ);
  SPLATLAS_RETURN_IF_ERROR(require_voxels(options, atlas, drawn, runs, cache, max_memory_bytes, pool));
  level_ = may_be_rough(options) && options.classification == Classification::kBefore
               ? pace_.next(voxel_pixels_of(view, atlas.grid()), true).level
               : 0;
  if (level_ == 0 || (means_ && means_level_ == level_)) return {};
  means_.reset();
  if (auto means = volume_->means(runs, level_, pool)) {
    means_ = *std::move(means);
    means_level_ = level_;
  } else {
    level_ = 0;
  }
  return {};
}

Result<void> RayStore::require_voxels(const RenderOptions& options, const Atlas& atlas,
                                      const DrawnSelection& drawn, const SelectedRuns& runs,
                                      const ClassCache& cache, std::uint64_t max_memory_bytes,
                                      ThreadPool& pool) {
  if (!fits(options)) {
    if (!by_blocks_) clear();  // blocks are small, and serve again if the voxels do not fit
    SPLATLAS_ASSIGN_OR_RETURN(RayVolume built,
                              RayVolume::build({.atlas = atlas,
                                                .selection = drawn.selection(),
                                                .plan = drawn.plan(),
                                                .appearances = drawn.appearances().appearances(),
                                                .runs = runs,
                                                .cache = cache,
                                                .classification = options.classification,
                                                .shade = options.hybrid_shading,
                                                .max_memory_bytes = max_memory_bytes},
                                               pool));
    clear();
    volume_ = std::move(built);
  }
  if (!options.ids || volume_->numbers() != nullptr) return {};
  return volume_->number(runs, drawn.numbers(), pool);
}

Result<void> RayStore::require_walk(const View& view, const RenderOptions& options,
                                    const std::shared_ptr<const Atlas>& atlas, const DrawnSelection& drawn,
                                    const ClassCache& cache, std::uint64_t max_memory_bytes,
                                    ThreadPool& pool) {
  RenderOptions unlit = options;
  unlit.hybrid_shading = false;
  Result<void> built = require(view, unlit, *atlas, drawn, cache, max_memory_bytes, pool);
  if (built || built.error().code != ErrorCode::kLimit) return built;
  if (!options.ids && !options.depths && require_blocks(unlit, atlas, drawn, max_memory_bytes, pool))
    return {};
  built.error().message += ", or render without ids, depth map, outlines and depth cue";
  return built;
}

bool RayStore::require_blocks(const RenderOptions& options, const std::shared_ptr<const Atlas>& atlas,
                              const DrawnSelection& drawn, std::uint64_t max_memory_bytes, ThreadPool& pool) {
  if (by_blocks_ && volume_->fits(Classification::kBefore, options.hybrid_shading)) return true;
  clear();
  const auto read = BlockVolume::read(atlas, drawn.plan(), pool);
  if (!read) return false;
  BlockVolume& blocks = **read;
  blocks.require(Axis::kZ, pool);
  VolumeAppearances appearances(*atlas);
  appearances.select(blocks.plan(), drawn.selection());
  if (options.hybrid_shading)
    light_voxels(blocks.plan(), appearances, blocks.classes(), blocks.grid(), blocks.cache(), pool);
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
  by_blocks_ = true;
  level_ = kMeanLevel;
  return true;
}

void RayStore::clear() {
  volume_.reset();
  means_.reset();
  by_blocks_ = false;
  level_ = 0;
}

}  // namespace splatlas
