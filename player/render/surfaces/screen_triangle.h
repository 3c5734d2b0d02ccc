// Exact integer edge functions of a triangle in screen space (Pineda 1988).
#pragma once

#include <array>
#include <cstdint>
#include <cstdlib>
#include <utility>

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

}  // namespace splatlas
