// Ray volume of a renderer's selection.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "player/render/frame/decoded_selection.h"
#include "player/render/frame/drawn_selection.h"
#include "player/render/rays/volume/ray_volume.h"
#include "player/render_options.h"

namespace splatlas {

/// Cache of the ray volume of the current selection: its voxels, or blocks of voxels that stand in for them.
/// Not thread-safe.
class RayStore {
 public:
  /// True if the volume can draw with these options: require() will build nothing.
  [[nodiscard]] bool fits(const RenderOptions& options) const {
    return volume_ && !blocks_ && volume_->fits(options.classification, options.hybrid_shading);
  }
  /// Builds the volume, and numbers its voxels for ids, unless that is done. Errors and cost as for
  /// RayVolume::build().
  [[nodiscard]] Result<void> require(const RenderOptions& options, const Atlas& atlas,
                                     const DrawnSelection& drawn, const ClassCache& cache,
                                     std::uint64_t max_memory_bytes, ThreadPool& pool);
  /// Reads blocks of voxels instead, pre-classified. False on any error, which reading the voxels will tell.
  [[nodiscard]] bool require_blocks(const RenderOptions& options, const std::shared_ptr<const Atlas>& atlas,
                                    const DrawnSelection& drawn, std::uint64_t max_memory_bytes,
                                    ThreadPool& pool);
  /// Drops the volume. Does not throw.
  void clear() {
    volume_.reset();
    blocks_.reset();
  }

  /// The volume; require() or require_blocks() must have succeeded.
  [[nodiscard]] RayVolume& volume() { return *volume_; }
  /// The grid of blocks; null: the volume is one of voxels.
  [[nodiscard]] const Grid* blocks() const { return blocks_ ? &*blocks_ : nullptr; }

 private:
  std::optional<RayVolume> volume_;
  std::optional<Grid> blocks_;
};

}  // namespace splatlas
