// A cluster of triangles on the screen.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "player/render/surfaces/raster_kernels.h"
#include "player/render/surfaces/raster_scene.h"

namespace splatlas {

/// The vertices of the current cluster, and its triangles in a box. Keeps its memory between clusters.
class ScreenCluster {
 public:
  /// Projects the vertices. `cuts`: planes that may remove some; null: none.
  void place(const SurfaceClusters::Cluster& cluster, const RasterScene& scene, const CutRays* cuts);
  /// The numbers of the triangles whose pixels_of() with this reach meet a box; all if a vertex is off the
  /// screen.
  [[nodiscard]] std::span<const std::uint32_t> triangles_in(const PixelBox& box, std::int32_t reach);

  [[nodiscard]] ScreenVertex snapped(std::size_t vertex) const {
    return {snapped_x_[vertex], snapped_y_[vertex]};
  }
  [[nodiscard]] ScreenPoint point(std::size_t vertex) const { return points_[vertex]; }
  [[nodiscard]] float depth(std::size_t vertex) const { return depths_[vertex]; }
  /// Planes of the cut that remove a vertex, as bits.
  [[nodiscard]] std::uint8_t removing(std::size_t vertex) const { return removing_[vertex]; }

 private:
  static constexpr std::size_t kVertices = 3 * SurfaceClusters::kMaxTriangles;

  bool is_on_ = false;  // the screen, with all vertices
  std::span<const SurfaceClusters::Triangle> triangles_;
  std::array<ScreenPoint, kVertices> points_{};
  std::array<std::int32_t, kVertices + kRasterPadding> snapped_x_{}, snapped_y_{};
  std::array<float, kVertices> depths_{};
  std::array<std::uint8_t, kVertices> removing_{};
  std::array<std::uint32_t, SurfaceClusters::kMaxTriangles + kRasterPadding> corners_{}, chosen_{};
};

}  // namespace splatlas
