#include "player/view_depth.h"

namespace splatlas {

ViewDepth::ViewDepth(const View& view, const Grid& grid)
    : perspective_(view.eye_mm.has_value()), eye_mm_(view.eye_mm.value_or(0)) {
  const Affine to_index = lps_mm_to_index(grid);
  const ParallelView& plane = view.plane;
  Vec3 right = plane.right_lps, down = plane.up_lps;
  for (std::size_t a = 0; a < 3; ++a) {
    right[a] *= plane.mm_per_pixel;
    down[a] *= -plane.mm_per_pixel;
  }
  eye_ = to_index.apply(view.eye_lps_mm());
  corner_ = to_index.apply(plane.point_lps_mm(0, 0));
  right_ = to_index.apply_linear(right);
  down_ = to_index.apply_linear(down);
  forward_ = to_index.apply_linear(plane.forward_lps);
}

Vec3 ViewDepth::index_at(double x, double y, double depth_mm) const {
  Vec3 index{};
  for (std::size_t a = 0; a < 3; ++a) {
    const double on_plane = corner_[a] + x * right_[a] + y * down_[a];
    index[a] = perspective_ ? eye_[a] + (1 + depth_mm / eye_mm_) * (on_plane - eye_[a])
                            : on_plane + depth_mm * forward_[a];
  }
  return index;
}

}  // namespace splatlas
