// Ray volume of the current selection, with lit boundary voxels.
#pragma once

#include <cstdint>
#include <optional>

#include "player/camera.h"
#include "player/rays/ray_volume.h"
#include "player/transfer/shading.h"

namespace splatlas {

/// Cache of one ray volume, keyed by classification and shading. Not thread-safe.
class RayVolumeStore {
 public:
  [[nodiscard]] bool holds(Classification classification, bool shade) const;
  /// Replaces the volume. Errors of RayVolume::build() leave the store empty.
  [[nodiscard]] Result<void> build(const RayVolumeRequest& request, ThreadPool& pool);
  /// Lights boundary voxels, once per view direction.
  void light(const ParallelView& view, const Lighting& lighting, ThreadPool& pool);
  void clear() { held_.reset(); }

  /// The volume. Requires a successful build().
  [[nodiscard]] const RayVolume& volume() const { return held_->volume; }
  /// Number of runs of the volume.
  [[nodiscard]] std::uint64_t runs() const { return held_->runs; }

 private:
  struct Held {
    RayVolume volume;
    Classification classification = Classification::kBefore;
    bool shaded = false;
    std::uint64_t runs = 0;
    std::optional<ParallelView> lit_for = std::nullopt;  // none: not lit, or partly lit
  };
  std::optional<Held> held_;
};

}  // namespace splatlas
