#include "player/view/view_depth.h"

namespace splatlas {

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
