// Ray volume of a renderer's selection.
#pragma once

#include <cstdint>
#include <optional>

#include "player/render/frame/decoded_selection.h"
#include "player/render/frame/drawn_selection.h"
#include "player/render/rays/volume/ray_volume.h"
#include "player/render_options.h"

namespace splatlas {

/// Cache of the ray volume of the current selection. Not thread-safe.
class RayStore {
 public:
  /// True if the volume can draw with these options: require() will build nothing.
  [[nodiscard]] bool fits(const RenderOptions& options) const {
    return volume_ && volume_->fits(options.classification, options.hybrid_shading);
  }
  /// Builds the volume, and numbers its voxels for ids, unless that is done. Errors and cost as for
  /// RayVolume::build().
  [[nodiscard]] Result<void> require(const RenderOptions& options, const Atlas& atlas,
                                     const DrawnSelection& drawn, const ClassCache& cache,
                                     std::uint64_t max_memory_bytes, ThreadPool& pool);
  /// Drops the volume. Does not throw.
  void clear() { volume_.reset(); }

  /// The volume; require() must have succeeded.
  [[nodiscard]] RayVolume& volume() { return *volume_; }

 private:
  std::optional<RayVolume> volume_;
};

}  // namespace splatlas
