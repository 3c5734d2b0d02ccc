// Ray volume of the current selection, and the lighting of its shaded voxels.
#pragma once

#include <cstdint>
#include <optional>

#include "player/camera.h"
#include "player/rays/ray_volume.h"
#include "player/transfer/shading.h"

namespace splatlas {

/// Builds a ray volume once per selection, classification and kind of shading.
class RayVolumeStore {
 public:
  [[nodiscard]] bool holds(Classification classification, bool shade) const;
  /// Replaces the volume. Errors as those of RayVolume::build(); nothing is held then.
  [[nodiscard]] Result<void> build(const RayVolumeRequest& request, ThreadPool& pool);
  /// Lights boundary voxels, once per direction of view.
  void light(const ParallelView& view, const Lighting& lighting, ThreadPool& pool);
  void clear() { held_.reset(); }

  /// Only after build().
  [[nodiscard]] const RayVolume& volume() const { return held_->volume; }
  /// Runs that it was built from.
  [[nodiscard]] std::uint64_t runs() const { return held_->runs; }

 private:
  struct Held {
    RayVolume volume;
    Classification classification = Classification::kBefore;
    bool shaded = false;
    std::uint64_t runs = 0;
    std::optional<ParallelView> lit_for = std::nullopt;  // none: not lit, or partly
  };
  std::optional<Held> held_;
};

}  // namespace splatlas
