// The rays of a view through points of its picture, ready to march.
#pragma once

#include <array>
#include <optional>

#include "format/grid.h"
#include "format/run_model.h"
#include "player/camera.h"
#include "player/rays/march_kernels.h"
#include "player/view/view_frame.h"

namespace splatlas {

/// One number per ray of a packet.
using RayNumbers = std::array<double, kPacketRays>;

/// Rays in positions of a ray volume, linear in picture coordinates.
class PixelRays {
 public:
  /// `first`: the voxel of the grid that position (0, 0, 0) is at. `principal_axis`: forced, where no more
  /// than 100 voxels lie between its planes; the best one of each ray when not set.
  PixelRays(const View& view, const Grid& grid, const Index3& first,
            const std::optional<Axis>& principal_axis);

  /// Through picture coordinates (x, y): t counts planes along each ray's principal axis. In perspective rays
  /// begin at the eye, in parallel views in front of everything; they do not end.
  [[nodiscard]] RayPacket through(const RayNumbers& x, const RayNumbers& y) const;

 private:
  struct Lines;
  [[nodiscard]] Lines from_eye(const RayNumbers& x, const RayNumbers& y) const;
  [[nodiscard]] Lines side_by_side(const RayNumbers& x, const RayNumbers& y) const;
  [[nodiscard]] std::size_t principal_axis(const Lines& lines, std::size_t n) const;
  [[nodiscard]] bool is_principal(const Lines& lines, std::size_t axis) const;
  void set_rays(const Lines& lines, std::size_t principal, std::size_t first, std::size_t last,
                RayPacket& packet) const;

  bool perspective_;
  std::optional<Axis> forced_;
  ViewFrame frame_;  // voxels
  double eye_mm_ = 0, mm_per_pixel_ = 0, middle_x_ = 0, middle_y_ = 0;
};

}  // namespace splatlas
