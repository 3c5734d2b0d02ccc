// A triangle in screen space: exact integer edge functions (Pineda 1988), and its attributes.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <utility>

#include "player/render/surfaces/raster_scene.h"
#include "player/render/surfaces/triangle_bins.h"

namespace splatlas {

inline constexpr std::int32_t kHalfPixel = 1 << (kSubPixelBits - 1);

/// Twice the signed area; positive for clockwise winding on the screen.
[[nodiscard]] inline std::int64_t doubled_area(const ScreenVertex& a, const ScreenVertex& b,
                                               const ScreenVertex& c) {
  return std::int64_t{b.x - a.x} * (c.y - a.y) - std::int64_t{b.y - a.y} * (c.x - a.x);
}

/// A triangle with clockwise winding, so that edge functions are positive inside.
struct ScreenTriangle {
  TriangleRef ref;
  std::array<ScreenVertex, 3> corner;
  std::int64_t area = 0;  ///< twice the area; 0 if degenerate
  /// Top-left rule: 0 for left and top edges, whose points are inside, else 1.
  std::array<std::int64_t, 3> opened{};

  ScreenTriangle(const TriangleRef& triangle, std::array<ScreenVertex, 3> v) : ref(triangle), corner(v) {
    area = doubled_area(v[0], v[1], v[2]);
    turned_ = area < 0;
    if (turned_) {
      std::swap(corner[1], corner[2]);
      area = -area;
    }
    for (std::size_t n = 0; n < 3; ++n) {
      const ScreenVertex& from = corner[(n + 1) % 3];
      const ScreenVertex& to = corner[(n + 2) % 3];
      opened[n] = to.y < from.y || (to.y == from.y && to.x > from.x) ? 0 : 1;
    }
  }
  /// Barycentric weights of the mesh's corners from the edge functions.
  [[nodiscard]] std::array<float, 3> weights(const std::array<std::int64_t, 3>& edges) const {
    const double per_area = 1 / static_cast<double>(area);
    std::array<float, 3> weight{};
    for (std::size_t n = 0; n < 3; ++n) {
      weight[n] = static_cast<float>(static_cast<double>(edges[n] + opened[n]) * per_area);
    }
    if (turned_) std::swap(weight[1], weight[2]);
    return weight;
  }

 private:
  bool turned_ = false;
};

/// Incremental edge functions of a triangle; edge n is opposite corner n. Open edges are biased by -1, so
/// that a point is inside if no edge function is negative.
class EdgeWalk {
 public:
  using Edges = std::array<std::int64_t, 3>;

  EdgeWalk(const ScreenTriangle& t, std::int32_t x, std::int32_t y) {
    const ScreenVertex center{x << kSubPixelBits, y << kSubPixelBits};
    for (std::size_t n = 0; n < 3; ++n) {
      const ScreenVertex& from = t.corner[(n + 1) % 3];
      const ScreenVertex& to = t.corner[(n + 2) % 3];
      first_[n] = doubled_area(from, to, center) - t.opened[n];
      per_x_[n] = from.y - to.y;
      per_y_[n] = to.x - from.x;
      reach_[n] = (std::abs(per_x_[n]) + std::abs(per_y_[n])) * kHalfPixel;
    }
  }
  [[nodiscard]] Edges row(std::int64_t down) const {
    Edges edges = first_;
    for (std::size_t n = 0; n < 3; ++n) edges[n] += (down << kSubPixelBits) * per_y_[n];
    return edges;
  }
  void step(Edges& edges) const {
    for (std::size_t n = 0; n < 3; ++n) edges[n] += per_x_[n] << kSubPixelBits;
  }
  [[nodiscard]] Edges moved(Edges edges, const SubPixel& by) const {
    for (std::size_t n = 0; n < 3; ++n) edges[n] += by.x * per_x_[n] + by.y * per_y_[n];
    return edges;
  }
  /// True if no point of the pixel is inside.
  [[nodiscard]] bool misses_pixel(const Edges& at_center) const {
    return ((at_center[0] + reach_[0]) | (at_center[1] + reach_[1]) | (at_center[2] + reach_[2])) < 0;
  }
  static bool inside(const Edges& edges) { return (edges[0] | edges[1] | edges[2]) >= 0; }

 private:
  Edges first_{}, per_x_{}, per_y_{};
  Edges reach_{};  // maximum increase of an edge function within half a pixel
};

/// Attribute set-up of a triangle, done at its first covered sample. It uses vertices before snapping, so
/// that coplanar triangles have equal depths at the same sample, whatever their tessellation.
class TriangleAttributes {
 public:
  TriangleAttributes(const RasterScene& scene, const TriangleRef& ref);

  [[nodiscard]] bool front() const { return front_; }
  /// Depth at picture coordinates (x, y) with integer pixel centres, clamped to the depths of the corners.
  /// Snapped triangles may cover samples just outside the original one.
  [[nodiscard]] double depth_at(double x, double y) const {
    const double depth = at(depth_, x, y) / (parallel_ ? 1 : at(inverse_w_, x, y));
    return std::clamp(depth, nearest_, furthest_);
  }
  /// Converts screen-space weights of the rasterised corners to barycentric weights of the mesh's corners.
  void correct(std::array<float, 3>& weight) const {
    if (!parallel_) {
      float sum = 0;
      for (std::size_t n = 0; n < 3; ++n) {
        weight[n] *= static_cast<float>(per_w_[n]);
        sum += weight[n];
      }
      for (float& w : weight) w /= sum;
    }
    if (part_ == nullptr) return;
    const std::array<double, 3> of_part{weight[0], weight[1], weight[2]};
    for (std::size_t n = 0; n < 3; ++n) {
      weight[n] = static_cast<float>(
          dot(of_part, Vec3{part_->weights[0][n], part_->weights[1][n], part_->weights[2][n]}));
    }
  }

 private:
  /// Linear function in screen space.
  struct ScreenPlane {
    double at_origin = 0, per_x = 0, per_y = 0;
  };

  [[nodiscard]] double at(const ScreenPlane& plane, double x, double y) const {
    return plane.at_origin + plane.per_x * (x - x0_) + plane.per_y * (y - y0_);
  }

  bool parallel_;
  const ClippedTriangle* part_;
  bool front_ = true;
  double x0_ = 0, y0_ = 0, nearest_ = 0, furthest_ = 0;
  std::array<double, 3> per_w_{1, 1, 1};
  ScreenPlane depth_, inverse_w_{1, 0, 0};
};

}  // namespace splatlas
