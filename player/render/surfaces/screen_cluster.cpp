#include "player/render/surfaces/screen_cluster.h"

#include <numeric>

namespace splatlas {

void ScreenCluster::place(const SurfaceClusters::Cluster& cluster, const RasterScene& scene,
                          const CutRays* cuts) {
  triangles_ = cluster.triangles;
  is_on_ = true;
  const auto sign = static_cast<float>(scene.depth_sign);
  for (std::size_t n = 0; n < cluster.positions_ijk.size(); ++n) {
    const std::array<float, 3>& position = cluster.positions_ijk[n];
    points_[n] = scene.projection.on_screen(position);
    const ScreenVertex vertex = splatlas::snapped(points_[n]);
    snapped_x_[n] = vertex.x;
    snapped_y_[n] = vertex.y;
    is_on_ = is_on_ && vertex.is_on();
    depths_[n] = sign * position[scene.depth_axis];
    removing_[n] = cuts != nullptr ? cuts->removing(position) : 0;
  }
}

std::span<const std::uint32_t> ScreenCluster::triangles_in(const PixelBox& box, std::int32_t reach) {
  if (!is_on_) {
    std::iota(chosen_.begin(), chosen_.end(), 0U);
    return std::span(chosen_).first(triangles_.size());
  }
  for (std::size_t n = 0; n < triangles_.size(); ++n) {
    const auto& [a, b, c] = triangles_[n].corners;
    corners_[n] = static_cast<std::uint32_t>(a | b << 8 | c << 16);
  }
  const std::size_t count = select_triangles(
      corners_.data(), triangles_.size(), {snapped_x_.data(), snapped_y_.data()}, box, reach, chosen_.data());
  return std::span(chosen_).first(count);
}

}  // namespace splatlas
