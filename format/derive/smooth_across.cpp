#include <algorithm>
#include <cmath>
#include <cstddef>

#include "format/derive/surface_net.h"
#include "format/tasks/task_control.h"

namespace splatlas {
namespace {

using Vec3f = std::array<float, 3>;

Vec3f operator+(const Vec3f& a, const Vec3f& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
Vec3f operator-(const Vec3f& a, const Vec3f& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Vec3f operator*(float s, const Vec3f& a) {
  return {s * a[0], s * a[1], s * a[2]};
}

/// Planes between a vertex and its neighbours.
struct Planes {
  std::array<Vec3f, 4> normals{}, ways{};  // ways: to the neighbours, before both move
  std::array<float, 4> shares{};           // of the way to each plane
  std::array<float, 2> slides{};           // along the surface: of the ways to two opposite neighbours
  Vec3f normal{};                          // of the vertex
  float reach = 0;
};

/// Lengths are in sides of a voxel along its longest axis.
class AcrossSlices {
 public:
  AcrossSlices(const SurfaceNet& net, const SmoothedNet& smoothed, const Grid& grid)
      : net_(net), size_(grid.size) {
    const double thick = std::ranges::max(grid.spacing_mm);
    for (std::size_t a = 0; a < 3; ++a) sides_[a] = static_cast<float>(grid.spacing_mm[a] / thick);
    now_.resize(net.vertices.size());
    next_.resize(net.vertices.size());
    planes_.resize(net.vertices.size());
    find_planes(smoothed);
  }

  std::vector<Vec3f> move(int steps) {
    for (int step = 0; step < steps; ++step) {
      check_task();
      for (std::size_t v = 0; v < now_.size(); ++v) next_[v] = moved(v);
      now_.swap(next_);
    }
    for (std::size_t v = 0; v < now_.size(); ++v) now_[v] = position(v);
    return std::move(now_);
  }

 private:
  void find_planes(const SmoothedNet& smoothed) {
    std::vector<Vec3f>& normals = next_;
    for (std::size_t v = 0; v < normals.size(); ++v) {
      for (std::size_t a = 0; a < 3; ++a)
        normals[v][a] = static_cast<float>(smoothed.directions[v][a]) / sides_[a];
      const float length = std::sqrt(dot(normals[v], normals[v]));
      for (float& n : normals[v]) n /= length;
    }
    for (std::size_t v = 0; v < normals.size(); ++v) {
      Planes& planes = planes_[v];
      planes.normal = normals[v];
      const Vec3f here = middle(v);
      std::array<float, 4>& trust = planes.shares;
      for (std::size_t slot = 0; slot < 4; ++slot) {
        const std::uint32_t other = net_.neighbours[v][slot];
        const Vec3f sum = normals[v] + normals[other];
        const float length = std::sqrt(dot(sum, sum));
        trust[slot] = other == v ? 0 : std::clamp(5 * length - 8, 0.0f, 1.0f);
        if (!(trust[slot] > 0)) continue;
        const Vec3f there = middle(other);
        for (std::size_t a = 0; a < 3; ++a) {
          planes.normals[slot][a] = sum[a] / length;
          planes.ways[slot][a] = sides_[a] * (there[a] - here[a]);
        }
      }
      const float total = (trust[0] + trust[1]) + (trust[2] + trust[3]);
      planes.reach = total / 8;
      if (!(total > 0)) continue;
      for (std::size_t n = 0; n < 2; ++n)
        planes.slides[n] = 0.1875f * std::min(trust[2 * n], trust[2 * n + 1]) / total;
      for (float& share : planes.shares) share = 0.875f * share / total;
    }
  }

  /// The middle of a vertex's edge.
  [[nodiscard]] Vec3f middle(std::size_t v) const {
    const NetVertex& vertex = net_.vertices[v];
    Vec3f position;
    for (std::size_t a = 0; a < 3; ++a) position[a] = static_cast<float>(vertex.voxel[a]);
    position[vertex.axis()] += 0.5f;
    return position;
  }

  [[nodiscard]] Vec3f moved(std::size_t v) const {
    const Planes& planes = planes_[v];
    std::array<Vec3f, 4> ways, up;
    for (std::size_t slot = 0; slot < 4; ++slot) {
      const Vec3f& normal = planes.normals[slot];
      ways[slot] = planes.ways[slot] + (now_[net_.neighbours[v][slot]] - now_[v]);
      up[slot] = (planes.shares[slot] * dot(normal, ways[slot])) * normal;
    }
    const Vec3f slide = planes.slides[0] * (ways[0] + ways[1]) + planes.slides[1] * (ways[2] + ways[3]);
    const Vec3f along = slide - dot(planes.normal, slide) * planes.normal;
    const Vec3f way = now_[v] + (((up[0] + up[1]) + (up[2] + up[3])) + along);
    const float squared = dot(way, way);
    return squared > planes.reach * planes.reach ? (planes.reach / std::sqrt(squared)) * way : way;
  }

  /// Rounded about the middle of the edge: mirrored masks have mirrored surfaces.
  [[nodiscard]] Vec3f position(std::size_t v) const {
    constexpr auto kScale = static_cast<float>(SurfaceRule::kUneven);
    Vec3f position = middle(v);
    for (std::size_t a = 0; a < 3; ++a) {
      const float way = std::round(kScale * (now_[v][a] / sides_[a])) / kScale;
      position[a] = std::clamp(position[a] + way, -1.0f, static_cast<float>(size_[a]));
    }
    return position;
  }

  const SurfaceNet& net_;
  Index3 size_;
  Vec3f sides_{};
  std::vector<Vec3f> now_, next_;  // ways from the middles of the edges
  std::vector<Planes> planes_;
};

}  // namespace

std::vector<std::array<float, 3>> smooth_across(const SurfaceNet& net, const SmoothedNet& smoothed,
                                                const Grid& grid) {
  constexpr int kSteps = 14;
  return AcrossSlices(net, smoothed, grid).move(kSteps);
}

}  // namespace splatlas
