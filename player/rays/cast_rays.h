// Pictures by rays: one through the centre of every pixel, in either projection.
#pragma once

#include <cstdint>
#include <optional>

#include "format/system/thread_pool.h"
#include "player/camera.h"
#include "player/picture.h"
#include "player/rays/march_kernels.h"
#include "player/rays/ray_volume.h"

namespace splatlas {

/// How rays march.
struct CastOptions {
  int min_steps = 1, max_steps = 1;  ///< per slab, the space between two planes of voxels
  float tolerance = 0;              ///< where more than the least are taken (MarchKernels::march); 0: nowhere
  float termination_threshold = 0;  ///< early ray termination; also bounds the error of a value
  std::optional<Axis> principal_axis =
      std::nullopt;  ///< forced, to measure what the choice costs; the best one of each ray when not set
};

/// `volume` as the kernels take it; it must outlive the scene.
[[nodiscard]] MarchScene march_scene(const RayVolume& volume, const CastOptions& options);

/// Renders the volume. Each ray is sampled where it meets the planes of voxels normal to the axis along which
/// it passes most of them, and in between where that changes the picture; in perspective it begins at the
/// eye, wherever that is. Blocks of 4x4 pixels march together; pictures do not depend on the number of
/// threads.
void cast_rays(const RayVolume& volume, const View& view, const Grid& grid, const CastOptions& options,
               const MarchKernels& kernels, Picture& picture, ThreadPool& pool);

}  // namespace splatlas
