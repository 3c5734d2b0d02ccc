#include "player/render/surfaces/screen_cluster.h"

#include <algorithm>
#include <numeric>

namespace splatlas {

void ScreenCluster::place(const SurfaceClusters::Cluster& cluster, const RasterScene& scene,
                          const CutRays* cuts) {
  triangles_ = cluster.triangles;
  const std::size_t count = cluster.positions_ijk.size();
  for (std::size_t n = 0; n < count; ++n) {
    for (std::size_t a = 0; a < 3; ++a) ijk_[a][n] = cluster.positions_ijk[n][a];
  }
  const auto sign = static_cast<float>(scene.depth_sign);
  for (std::size_t n = 0; n < count; ++n) depths_[n] = sign * ijk_[scene.depth_axis][n];
  std::fill_n(removing_.begin(), count, std::uint8_t{0});
  if (cuts != nullptr) {
    for (std::size_t n = 0; n < count; ++n) removing_[n] = cuts->removing(cluster.positions_ijk[n]);
  }
  // A parallel view is projected by vectors; padding repeats the last vertex, to be on the screen with it
  is_on_ = false;
  if (scene.projection.is_parallel() && count > 0) {
    for (std::size_t a = 0; a < 3; ++a)
      std::fill_n(ijk_[a].begin() + static_cast<std::ptrdiff_t>(count), kRasterPadding, ijk_[a][count - 1]);
    std::fill_n(w_.begin(), count, 1.0);
    is_on_ = raster_kernels().place(scene.projection, {ijk_[0].data(), ijk_[1].data(), ijk_[2].data()}, count,
                                    {x_.data(), y_.data(), snapped_x_.data(), snapped_y_.data()});
    if (is_on_) return;
  }
  is_on_ = true;
  for (std::size_t n = 0; n < count; ++n) {
    const ScreenPoint point = scene.projection.on_screen(cluster.positions_ijk[n]);
    const ScreenVertex vertex = splatlas::snapped(point);
    x_[n] = point.x;
    y_[n] = point.y;
    w_[n] = point.w;
    snapped_x_[n] = vertex.x;
    snapped_y_[n] = vertex.y;
    is_on_ = is_on_ && vertex.is_on();
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
  const std::size_t count = raster_kernels().select(
      corners_.data(), triangles_.size(), {x_.data(), y_.data(), snapped_x_.data(), snapped_y_.data()}, box,
      reach, chosen_.data());
  return std::span(chosen_).first(count);
}

}  // namespace splatlas
