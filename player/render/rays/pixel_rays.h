// Rays through points of the picture, in the coordinates of a ray volume.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "format/content/grid.h"
#include "player/camera.h"
#include "player/render/clip/cut_rays.h"
#include "player/render/rays/march_kernels.h"
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

}  // namespace splatlas
