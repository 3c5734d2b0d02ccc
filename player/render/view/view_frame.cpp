#include "player/render/view/view_frame.h"

#include <cmath>

namespace splatlas {

ViewFrame::ViewFrame(const View& view, const Affine& from_lps_mm) {
  const ParallelView& plane = view.plane;
  Vec3 right_mm = plane.right_lps, down_mm = plane.up_lps;
  for (std::size_t a = 0; a < 3; ++a) {
    right_mm[a] *= plane.mm_per_pixel;
    down_mm[a] *= -plane.mm_per_pixel;
  }
  eye = from_lps_mm.apply(view.eye_lps_mm());
  corner = from_lps_mm.apply(plane.point_lps_mm(0, 0));
  right = from_lps_mm.apply_linear(right_mm);
  down = from_lps_mm.apply_linear(down_mm);
  forward = from_lps_mm.apply_linear(plane.forward_lps);
}

ViewDepth::ViewDepth(const View& view, const Grid& grid)
    : perspective_(view.eye_mm.has_value()),
      eye_mm_(view.eye_mm.value_or(0)),
      frame_(view, lps_mm_to_index(grid)) {}

Vec3 ViewDepth::index_at(double x, double y, double depth_mm) const {
  Vec3 index{};
  for (std::size_t a = 0; a < 3; ++a) {
    const double on_plane = frame_.corner[a] + x * frame_.right[a] + y * frame_.down[a];
    index[a] = perspective_ ? frame_.eye[a] + (1 + depth_mm / eye_mm_) * (on_plane - frame_.eye[a])
                            : on_plane + depth_mm * frame_.forward[a];
  }
  return index;
}

Projection::Projection(const ParallelView& view, const Grid& grid, double eye_mm)
    : parallel_(!std::isfinite(eye_mm)) {
  // Express pixel offsets from the view's centre as affine functions of the index
  const Affine to_lps = index_to_lps_mm(grid);
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = 0; b < 3; ++b) {
      x_[a] += view.right_lps[b] * to_lps.linear[3 * b + a] / view.mm_per_pixel;
      y_[a] -= view.up_lps[b] * to_lps.linear[3 * b + a] / view.mm_per_pixel;
      if (!parallel_) w_[a] += view.forward_lps[b] * to_lps.linear[3 * b + a] / eye_mm;
    }
    const double from_center = to_lps.offset[a] - view.center_lps_mm[a];
    x0_ += view.right_lps[a] * from_center / view.mm_per_pixel;
    y0_ -= view.up_lps[a] * from_center / view.mm_per_pixel;
    if (!parallel_) w0_ += view.forward_lps[a] * from_center / eye_mm;
  }
  // Move the origin from the picture's middle to its top left pixel centre
  const double middle_x = 0.5 * view.size.width - 0.5;
  const double middle_y = 0.5 * view.size.height - 0.5;
  for (std::size_t a = 0; a < 3; ++a) {
    x_[a] += w_[a] * middle_x;
    y_[a] += w_[a] * middle_y;
  }
  x0_ += w0_ * middle_x;
  y0_ += w0_ * middle_y;
}

}  // namespace splatlas
