// Ray casting, in either projection: the rays of pixels, and surfaces inside volumes, in exact order.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>

#include "format/content/grid.h"
#include "format/tasks/thread_pool.h"
#include "player/camera.h"
#include "player/picture.h"
#include "player/render/clip/cut_rays.h"
#include "player/render/clip/face_layer.h"
#include "player/render/contributions/pixel_shares.h"
#include "player/render/rays/march_kernels.h"
#include "player/render/rays/volume/ray_volume.h"
#include "player/render/surfaces/fragments.h"
#include "player/render/surfaces/raster_scene.h"
#include "player/render/view/view_frame.h"

namespace splatlas {

/// One number per ray of a packet.
using RayNumbers = std::array<double, kPacketRays>;

/// Picture coordinates of the rays of a packet.
struct RayPoints {
  RayNumbers x{}, y{};
};

/// Side of the block of pixels whose rays form a packet.
inline constexpr int kBlockSide = 4;
static_assert(std::size_t{kBlockSide} * kBlockSide == kPacketRays);

/// A grid of rays in a pixel.
struct RayGrid {
  int columns = 1, rows = 1;

  [[nodiscard]] int count() const { return columns * rows; }
};

/// Rays of a block of kBlockSide x kBlockSide pixels: a grid in each. As many packets of kBlockSide x
/// kBlockSide neighbouring rays as a pixel has rays cover the block.
struct RayBlock {
  int left = 0, top = 0;
  RayGrid grid{};

  /// Points of a packet, row by row. Beyond the edge of the picture they repeat its last ones.
  [[nodiscard]] RayPoints points(int packet, const PictureSize& size) const;
  /// The pixel of the n-th ray of a packet, counted row by row in the block.
  [[nodiscard]] std::size_t pixel(int packet, std::size_t n) const {
    return static_cast<std::size_t>(row(packet, n) / grid.rows * kBlockSide +
                                    column(packet, n) / grid.columns);
  }

 private:
  /// Place of the n-th ray of a packet among those of the block.
  [[nodiscard]] int column(int packet, std::size_t n) const {
    return packet % grid.columns * kBlockSide + static_cast<int>(n) % kBlockSide;
  }
  [[nodiscard]] int row(int packet, std::size_t n) const {
    return packet / grid.columns * kBlockSide + static_cast<int>(n) / kBlockSide;
  }
};

/// Principal axis of a ray of a packet.
[[nodiscard]] std::size_t principal_axis_of(const RayPacket& rays, std::size_t n);

/// The t at which a ray of a packet is at this place along an axis, counted from the packet's origin.
[[nodiscard]] inline float t_at(const RayPacket& rays, std::size_t n, std::size_t axis, double place) {
  return static_cast<float>((place - rays.origin[axis][n]) / rays.step[axis][n]);
}

/// Generator of ray packets. Thread-safe.
class PixelRays {
 public:
  /// `first`: the voxel of the grid at position (0, 0, 0). `principal_axis`: forced for rays within
  /// kMaxForcedSlope; by default the best axis of each ray.
  PixelRays(const View& view, const Grid& grid, const Index3& first,
            const std::optional<Axis>& principal_axis);

  /// Rays through points of the picture. t counts planes along the principal axis of each ray. Rays begin at
  /// the eye in perspective, else in front of the volume, and do not end.
  [[nodiscard]] RayPacket through(const RayPoints& points) const;
  /// Clips the rays through these points to the kept part.
  void clip(const CutRays& cuts, const RayPoints& points, RayPacket& packet) const;

 private:
  struct Lines;
  [[nodiscard]] Lines from_eye(const RayPoints& points) const;
  [[nodiscard]] Lines side_by_side(const RayPoints& points) const;
  [[nodiscard]] std::size_t principal_axis(const Lines& lines, std::size_t n) const;
  [[nodiscard]] bool is_principal(const Lines& lines, std::size_t axis) const;
  void set_rays(const Lines& lines, std::size_t principal, std::size_t first, std::size_t last,
                RayPacket& packet) const;

  bool perspective_;
  Index3 first_;
  std::optional<Axis> forced_;
  ViewFrame frame_;  // voxels
  double eye_mm_ = 0, mm_per_pixel_ = 0, middle_x_ = 0, middle_y_ = 0;
};

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
