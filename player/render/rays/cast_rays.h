// Ray casting, in either projection, and surfaces inside volumes, in exact order.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>

#include "format/tasks/thread_pool.h"
#include "player/camera.h"
#include "player/picture.h"
#include "player/render/clip/cut_rays.h"
#include "player/render/clip/face_layer.h"
#include "player/render/contributions/pixel_shares.h"
#include "player/render/rays/march_kernels.h"
#include "player/render/rays/pixel_rays.h"
#include "player/render/rays/volume/ray_volume.h"
#include "player/render/surfaces/fragments.h"
#include "player/render/surfaces/raster_scene.h"

namespace splatlas {

/// Shares of structures along the rays of a packet, and where each ray reaches half opacity. The opacity of a
/// step belongs to the structures of the eight voxels around its middle: in proportion to their extinctions
/// with pre-classification, and to the trilinear weights with post-classification. Not thread-safe.
class RayShares {
 public:
  /// `volume` must outlive the shares. Without structure numbers, it has depths alone.
  explicit RayShares(const RayVolume& volume);
  RayShares(const RayShares&) = delete;
  RayShares& operator=(const RayShares&) = delete;

  /// Begins with the rays of another packet. `rays` must outlive it; its interval may change.
  void begin(const RayPacket& rays);
  /// For RadiancePacket::trace.
  [[nodiscard]] MarchTrace* trace() { return &trace_; }
  /// Adds the steps of the last call of MarchKernels::march().
  void take();
  /// Adds a fragment, which has been composited: `opacity` is that of the ray behind it.
  void add_fragment(std::size_t ray, StructureIndex structure, float opacity);

  [[nodiscard]] const PixelShares& of_ray(std::size_t ray) const { return shares_[ray]; }
  /// The t at which the volume along a ray reaches an opacity of one half; infinite if it does not.
  [[nodiscard]] float depth_of_ray(std::size_t ray) const { return depths_[ray]; }

 private:
  struct Trace : MarchTrace {
    RayShares* owner = nullptr;
  };
  void add(std::size_t ray, float rise, float t);

  const RayVolume& volume_;
  const float* extinctions_ = nullptr;        // of voxels, every fourth float; null: post-classified
  const StructureNumber* numbers_ = nullptr;  // of voxels
  const StructureNumber* cells_ = nullptr;
  std::array<std::size_t, 8> corners_{};  // offsets of the voxels around a cell
  const RayPacket* rays_ = nullptr;
  std::array<float, kPacketRays> seen_{};  // opacity so far
  std::array<PixelShares, kPacketRays> shares_;
  std::array<float, kPacketRays> depths_{};
  Trace trace_;
};

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

/// Scene of the rasteriser for frames of rays, in either projection. kUsage if there is no depth_axis():
/// fields of view wider than about 70 degrees, from some directions.
[[nodiscard]] Result<RasterScene> raster_scene_of_rays(std::span<const SurfaceDraw> surfaces,
                                                       const View& view, const Grid& grid,
                                                       const Lighting& lighting);

/// Renders the pixels with fragments again. The ray of each sample alternates between the volume up to the
/// next fragment and the fragment; the pixel is the mean of its samples. Fragments are those of `scene`.
/// `picture`: null to find the ids alone. Cost: linear in the samples and the volume along their rays.
void cast_surfaces(const RayVolume& volume, const View& view, const Grid& grid, const RasterScene& scene,
                   const FragmentList& fragments, const CastOptions& options, const MarchKernels& kernels,
                   Picture* picture, ThreadPool& pool);

}  // namespace splatlas
