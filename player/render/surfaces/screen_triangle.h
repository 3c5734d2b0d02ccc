// A triangle in screen space: its clipping against the near plane and the guard band, exact integer edge
// functions (Pineda 1988), and perspective-correct interpolation of depth and barycentric weights.
// Kernels of the rasteriser (hot loops) on arrays of vertices.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <utility>
#include <vector>

#include "format/content/surface.h"
#include "player/render/view/pixel_box.h"
#include "player/render/view/view_frame.h"

namespace splatlas {

/// Near plane, relative to the distance from the eye to the view's centre.
inline constexpr double kNearPlane = 1e-4;
/// Limit of screen coordinates in pixels: vertices in 1/256 pixel fit 29 bits, and edge functions 64 bits.
inline constexpr double kGuardBand = double{1 << 20};

/// Part of a triangle inside the clip planes.
struct ClippedTriangle {
  std::uint32_t triangle = 0;
  std::array<ScreenPoint, 3> corner;
  std::array<std::array<double, 3>, 3> weights{};  ///< barycentric coordinates of each corner
};

/// Clips a triangle against the near plane and the guard band in homogeneous coordinates (Sutherland and
/// Hodgman 1974). Appends at most six parts, with the winding of the triangle. Triangles with a corner that
/// is not finite yield none. Shared edges stay watertight: their clipping is independent of the triangle.
void clip_triangle(const SurfaceMesh& mesh, std::uint32_t triangle, const Projection& projection,
                   std::vector<ClippedTriangle>& parts);

inline constexpr std::int32_t kHalfPixel = 1 << (kSubPixelBits - 1);

/// A vertex snapped to 1/256 pixel: edge functions are exact integers. Pixel centres: multiples of 256.
struct ScreenVertex {
  static constexpr std::int32_t kOff = std::numeric_limits<std::int32_t>::min();
  std::int32_t x = kOff, y = kOff;

  /// False for vertices outside the near plane or the guard band.
  [[nodiscard]] bool is_on() const { return x != kOff; }
};

/// Rounds to the nearest multiple of 1/256, ties to even.
[[nodiscard]] inline ScreenVertex snapped(const ScreenPoint& point) {
  const bool on = point.w >= kNearPlane && std::abs(point.x) < kGuardBand && std::abs(point.y) < kGuardBand;
  if (!on) return {};
  constexpr double kRounder = 0x1.8p52;  // doubles around it are consecutive integers
  const auto rounded = [](double value) {
    return static_cast<std::int32_t>(std::bit_cast<std::int64_t>(value * kSubPixels + kRounder));
  };
  return {rounded(point.x), rounded(point.y)};
}

/// Pixels with centres in the bounding box of a triangle, padded by `reach` (1/256 pixel).
[[nodiscard]] inline PixelBox pixels_of(const ScreenVertex& a, const ScreenVertex& b, const ScreenVertex& c,
                                        std::int32_t reach) {
  constexpr std::int32_t kUp = (1 << kSubPixelBits) - 1;
  const std::int32_t x_low = std::min(std::min(a.x, b.x), c.x) - reach;
  const std::int32_t x_high = std::max(std::max(a.x, b.x), c.x) + reach;
  const std::int32_t y_low = std::min(std::min(a.y, b.y), c.y) - reach;
  const std::int32_t y_high = std::max(std::max(a.y, b.y), c.y) + reach;
  return {(x_low + kUp) >> kSubPixelBits, x_high >> kSubPixelBits, (y_low + kUp) >> kSubPixelBits,
          y_high >> kSubPixelBits};
}

/// Twice the signed area; positive for clockwise winding on the screen.
[[nodiscard]] inline std::int64_t doubled_area(const ScreenVertex& a, const ScreenVertex& b,
                                               const ScreenVertex& c) {
  return std::int64_t{b.x - a.x} * (c.y - a.y) - std::int64_t{b.y - a.y} * (c.x - a.x);
}

/// A triangle with clockwise winding, so that edge functions are positive inside.
struct ScreenTriangle {
  std::array<ScreenVertex, 3> corner;
  std::int64_t area = 0;  ///< twice the area
  double per_area = 0;    ///< its inverse
  /// Top-left rule: 0 for left and top edges, whose points are inside, else 1.
  std::array<std::int64_t, 3> opened{};

  /// Corners, and their doubled_area(), which is not 0.
  ScreenTriangle(const std::array<ScreenVertex, 3>& v, std::int64_t signed_area)
      : corner(v), area(signed_area), turned_(signed_area < 0) {
    if (turned_) {
      std::swap(corner[1], corner[2]);
      area = -area;
    }
    per_area = 1 / static_cast<double>(area);
    for (std::size_t n = 0; n < 3; ++n) {
      const ScreenVertex& from = corner[(n + 1) % 3];
      const ScreenVertex& to = corner[(n + 2) % 3];
      opened[n] = to.y < from.y || (to.y == from.y && to.x > from.x) ? 0 : 1;
    }
  }
  /// Barycentric weights of the mesh's corners from the edge functions.
  [[nodiscard]] std::array<float, 3> weights(const std::array<std::int64_t, 3>& edges) const {
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

/// Edge functions of a triangle of at most kMaxSide pixels: all are below 2^31 around its pixels.
struct SmallEdges {
  static constexpr std::int32_t kMaxSide = 32;
  std::array<std::int32_t, 3> first{}, per_x{}, per_y{};  ///< at the first pixel; per pixel
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
  /// Edge functions at a pixel, from the first one.
  [[nodiscard]] Edges at(std::int64_t right, std::int64_t down) const {
    Edges edges = row(down);
    for (std::size_t n = 0; n < 3; ++n) edges[n] += (right << kSubPixelBits) * per_x_[n];
    return edges;
  }
  /// The same for the kernels.
  [[nodiscard]] SmallEdges small() const {
    SmallEdges small;
    for (std::size_t n = 0; n < 3; ++n) {
      small.first[n] = static_cast<std::int32_t>(first_[n]);
      small.per_x[n] = static_cast<std::int32_t>(per_x_[n] << kSubPixelBits);
      small.per_y[n] = static_cast<std::int32_t>(per_y_[n] << kSubPixelBits);
    }
    return small;
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
  /// Screen coordinates and depths of the corners. `part`: the clipped part that they belong to; null: none.
  TriangleAttributes(const std::array<ScreenPoint, 3>& points, const std::array<double, 3>& depths,
                     bool parallel, const ClippedTriangle* part);

  /// True for clockwise corners on the screen, before snapping.
  [[nodiscard]] bool is_clockwise() const { return clockwise_; }
  /// Depth at picture coordinates (x, y) with integer pixel centres, clamped to the depths of the corners.
  /// Snapped triangles may cover samples just outside the original one.
  [[nodiscard]] double depth_at(double x, double y) const {
    double depth = at(depth_, x, y);
    if (!parallel_) depth /= at(inverse_w_, x, y);
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
          dot(of_part, {part_->weights[0][n], part_->weights[1][n], part_->weights[2][n]}));
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
  bool clockwise_ = false;
  double x0_ = 0, y0_ = 0, nearest_ = 0, furthest_ = 0;
  std::array<double, 3> per_w_{1, 1, 1};
  ScreenPlane depth_, inverse_w_{1, 0, 0};
};

/// Kernels process whole vectors of at most as many lanes.
inline constexpr std::size_t kRasterPadding = 16;

/// ScreenVertex in arrays for SIMD.
struct SnappedVertices {
  const std::int32_t *x, *y;
};

// By the best instruction set; all give the same results.

/// Finds the triangles whose pixels_of() with this reach meet a box. Corners: one byte each, the first in the
/// lowest byte. Returns their number.
std::size_t select_triangles(const std::uint32_t* corners, std::size_t count, const SnappedVertices& vertices,
                             const PixelBox& box, std::int32_t reach, std::uint32_t* out);
/// Finds the pixels inside, one word for each row, and one bit for each column.
void cover_pixels(const SmallEdges& edges, std::int32_t columns, std::int32_t rows, std::uint32_t* out);

}  // namespace splatlas
