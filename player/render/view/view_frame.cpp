#include "player/render/view/view_frame.h"

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

}  // namespace splatlas
