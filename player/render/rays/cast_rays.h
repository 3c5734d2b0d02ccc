// Ray casting, in either projection.
#pragma once

#include <optional>
#include <span>

#include "format/tasks/thread_pool.h"
#include "player/camera.h"
#include "player/picture.h"
#include "player/render/clip/cut_rays.h"
#include "player/render/clip/face_layer.h"
#include "player/render/rays/march_kernels.h"
#include "player/render/rays/pixel_rays.h"
#include "player/render/rays/volume/ray_volume.h"
#include "player/render/surfaces/raster_scene.h"

namespace splatlas {

/// Opaque surfaces at which rays end. The picture shows them.
struct RayEnds {
  std::span<const float> depths;  ///< by pixel, as those of fragments in the grid of the volume
  const RasterScene& scene;       ///< of the surfaces
};

/// Sampling of rays.
struct CastOptions {
  RayGrid rays{};                    ///< in each pixel; the volume is their mean
  int min_steps = 1, max_steps = 1;  ///< per slab, the space between two planes of voxels
  float tolerance = 0;               ///< error bound of a step (MarchKernels::march); 0: always min_steps
  float termination_threshold = 0;   ///< early ray termination; also bounds the error of a value
  std::optional<Axis> principal_axis =
      std::nullopt;                  ///< forced, for measurements; by default the best axis of each ray
  const CutRays* cuts = nullptr;     ///< clips the volume; null: no cut
  const FaceLayer* faces = nullptr;  ///< of the cut, at pixel centres; null: none
  const RayEnds* ends = nullptr;     ///< the volume is composited in front of the picture; null: none
  /// Structures of the pixels, whatever their opacity; null: none. The volume must have structure numbers.
  IdImage* ids = nullptr;
  /// Merges the depths of the volume at pixel centres, by minimum; null: not asked for.
  DepthMap* depths = nullptr;
};

/// View of `volume` for the kernels. The volume must outlive the scene.
[[nodiscard]] MarchScene march_scene(const RayVolume& volume, const CastOptions& options);

/// Renders the volume. Each ray is sampled at the planes of voxels normal to its principal axis, and in
/// between as the tolerance requires. In perspective it begins at the eye, which may lie inside the volume.
/// Packets are 4x4 neighbouring rays. Pictures do not depend on the number of threads.
/// `picture`: null to find ids and depths alone.
void cast_rays(const RayVolume& volume, const View& view, const Grid& grid, const CastOptions& options,
               const MarchKernels& kernels, Picture* picture, ThreadPool& pool);

}  // namespace splatlas
