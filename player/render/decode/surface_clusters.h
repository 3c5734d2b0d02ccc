// Clusters of neighbouring triangles, the unit of work of the rasteriser.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "format/content/grid.h"
#include "format/content/surface.h"

namespace splatlas {

/// Triangles of a surface in clusters along a Morton curve (Morton 1966). A cluster is compact, has its own
/// vertices, and can be culled and rasterised on its own.
class SurfaceClusters {
 public:
  static constexpr std::size_t kMaxTriangles = 64;

  /// Front of a triangle, relative to its winding in LPS: of surfaces that may be wound either way, where the
  /// sum of its vertex normals points. An interpolated normal would fail at silhouettes, where it turns away
  /// from a visible front.
  enum class Front : std::uint8_t {
    kCounterClockwise,  ///< seen with counter-clockwise corners, as files have it
    kClockwise,
    kBoth,  ///< the normals define no front: zero, NaN, in the plane of the triangle
  };
  struct Triangle {
    std::array<std::uint8_t, 3> corners{};  ///< vertices of the cluster
    Front front = Front::kBoth;
  };
  /// Bounding box in voxel indices, of finite coordinates; empty without any.
  struct Box {
    std::array<float, 3> low, high;
    Box() {
      low.fill(std::numeric_limits<float>::infinity());
      high.fill(-std::numeric_limits<float>::infinity());
    }
  };
  struct Cluster {
    const Box& box;
    std::span<const std::array<float, 3>> positions_ijk;
    std::span<const Triangle> triangles;
    std::uint32_t first = 0;  ///< place of its first triangle among all of the surface
  };

  /// Without triangles.
  SurfaceClusters() = default;
  /// Sorts the triangles of a mesh in a grid. Linear in triangles: about 0.1 us each.
  SurfaceClusters(const SurfaceMesh& mesh, const Grid& grid);

  [[nodiscard]] std::size_t size() const { return boxes_.size(); }
  /// True for a fitted surface without a border: from outside, only counter-clockwise triangles are visible.
  [[nodiscard]] bool is_closed() const { return is_closed_; }
  [[nodiscard]] Cluster operator[](std::size_t n) const {
    const std::size_t first = n * kMaxTriangles;
    const std::size_t count = std::min(kMaxTriangles, triangles_.size() - first);
    return {boxes_[n],
            std::span(positions_).subspan(first_vertex_[n], first_vertex_[n + 1] - first_vertex_[n]),
            std::span(triangles_).subspan(first, count), static_cast<std::uint32_t>(first)};
  }
  /// Number in the mesh of the triangle in a place.
  [[nodiscard]] std::uint32_t number(std::uint32_t place) const { return numbers_[place]; }
  /// Normals of its corners, in LPS.
  [[nodiscard]] std::array<const float*, 3> normals(std::uint32_t place) const {
    const std::array<float, 3>* const normals = &normals_[first_vertex_[place / kMaxTriangles]];
    const auto& [a, b, c] = triangles_[place].corners;
    return {normals[a].data(), normals[b].data(), normals[c].data()};
  }

 private:
  bool is_closed_ = false;
  std::vector<Box> boxes_;
  std::vector<std::uint32_t> first_vertex_{0};
  std::vector<std::array<float, 3>> positions_, normals_;
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> numbers_;
};

}  // namespace splatlas
