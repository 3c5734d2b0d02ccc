#include "player/view/view_frame.h"

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

}  // namespace splatlas
