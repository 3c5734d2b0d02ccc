#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "format/tasks/thread_pool.h"
#include "preprocess/surfaces/extract_surfaces.h"
#include "preprocess/surfaces/vtk_surface.h"

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

/// `a` with length 1, or `otherwise` if it has none.
Vec3f unit(const Vec3f& a, const Vec3f& otherwise) {
  const float squared = dot(a, a);
  return squared > 1e-20f ? (1 / std::sqrt(squared)) * a : otherwise;
}

/// Lists of the places of each value of a sequence.
class Places {
 public:
  Places(std::size_t values, std::span<const std::uint32_t> sequence) : first_(values + 1, 0) {
    for (const std::uint32_t value : sequence) ++first_[value + 1];
    for (std::size_t n = 0; n < values; ++n) first_[n + 1] += first_[n];
    places_.resize(sequence.size());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t n = 0; n < sequence.size(); ++n)
      places_[next[sequence[n]]++] = static_cast<std::uint32_t>(n);
  }
  [[nodiscard]] std::span<const std::uint32_t> of(std::size_t value) const {
    return {places_.data() + first_[value], places_.data() + first_[value + 1]};
  }

 private:
  std::vector<std::size_t> first_;
  std::vector<std::uint32_t> places_;
};

/// A number for each voxel edge.
std::uint64_t number_of(const VoxelEdge& edge, const Grid& grid) {
  std::int64_t number = 0;
  for (const std::size_t a : {2, 1, 0}) number = number * (grid.size[a] + 1) + edge.low[a] + 1;
  return 3 * static_cast<std::uint64_t>(number) + edge.axis;
}

/// The surfaces of all structures. Each has its own corners, which begin as vertices of their own.
class JointSurfaces {
 public:
  JointSurfaces(std::span<SurfaceMesh* const> meshes, const Grid& grid, unsigned threads)
      : meshes_(meshes), size_(grid.size), to_index_(lps_mm_to_index(grid)), pool_(threads) {
    // Corner normals disagree on parts about one voxel thick. Their mean is no reliable plane normal.
    constexpr float kNone = 0.8f, kWhole = 0.9f;
    std::size_t vertices = 0, triangles = 0;
    for (const SurfaceMesh* mesh : meshes_) {
      vertices += mesh->positions_ijk.size();
      triangles += mesh->triangles.size();
    }
    vertex_of_.reserve(vertices);
    edges_.reserve(vertices);
    origins_.reserve(vertices);
    triangles_.reserve(triangles);
    facing_.reserve(triangles);
    trust_.reserve(triangles);
    const Affine to_lps = index_to_lps_mm(grid);
    for (const SurfaceMesh* mesh : meshes_) {
      const auto first = static_cast<std::uint32_t>(vertex_of_.size());
      for (const auto& [a, b, c] : mesh->triangles) {
        const std::vector<Vec3f>& normals = mesh->normals_lps;
        const Vec3f sum = normals[a] + normals[b] + normals[c];
        facing_.push_back(unit(sum, normals[a]));
        trust_.push_back(std::clamp((std::sqrt(dot(sum, sum)) / 3 - kNone) / (kWhole - kNone), 0.0f, 1.0f));
        triangles_.push_back({first + a, first + b, first + c});
      }
      for (const Vec3f& ijk : mesh->positions_ijk) {
        const Vec3 mm = to_lps.apply_linear({ijk[0], ijk[1], ijk[2]});  // the offset may be far
        vertex_of_.push_back(static_cast<std::uint32_t>(vertex_of_.size()));
        edges_.push_back(number_of(VoxelEdge(ijk), grid));
        origins_.push_back({static_cast<float>(mm[0]), static_cast<float>(mm[1]), static_cast<float>(mm[2])});
      }
    }
    positions_ = origins_;
  }

  /// Moves all vertices towards the planes of the triangles around them, at most `reach_mm` in all. Calls
  /// report(n) behind step n.
  template <typename Report>
  void fit(int steps, float reach_mm, const Report& report) {
    std::vector<std::uint32_t> uses_of;
    uses_of.reserve(3 * triangles_.size());
    for (const auto& corners : triangles_) {
      for (const std::uint32_t corner : corners) uses_of.push_back(vertex_of_[corner]);
    }
    const Places uses(positions_.size(), uses_of);
    std::vector<Vec3f> centres(triangles_.size()), moved(positions_.size());
    for (int step = 0; step < steps; ++step) {
      for_each(triangles_.size(), [&](std::size_t t) {
        const auto& [a, b, c] = triangles_[t];
        centres[t] = (1.0f / 3) * (at(a) + at(b) + at(c));
      });
      for_each(positions_.size(), [&](std::size_t v) {
        Vec3f sum{0, 0, 0};
        float trust = 0;
        for (const std::uint32_t use : uses.of(v)) {
          const Vec3f& n = facing_[use / 3];
          sum = sum + trust_[use / 3] * dot(n, centres[use / 3] - positions_[v]) * n;
          trust += trust_[use / 3];
        }
        const Vec3f way = positions_[v] + (1 / std::max(trust, 1e-6f)) * sum - origins_[v];
        const float reach = reach_mm * trust / static_cast<float>(uses.of(v).size());
        const float length = std::sqrt(dot(way, way));
        moved[v] = length <= reach ? origins_[v] + way : origins_[v] + (reach / length) * way;
      });
      positions_.swap(moved);
      report(step + 1);
    }
  }

  /// Joins the corners of a voxel edge that are at most `within_mm` from their mean. Structures that meet on
  /// a ledge between two slices alone have parted.
  void join(float within_mm) {
    std::vector<std::uint32_t> order(vertex_of_);
    std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) {
      return std::pair(edges_[a], a) < std::pair(edges_[b], b);
    });
    std::vector<Vec3f> positions, origins;
    std::vector<float> corners;
    std::size_t first = 0;  // vertex of the edge
    for (std::size_t n = 0; n < order.size(); ++n) {
      const std::uint32_t corner = order[n];
      if (n > 0 && edges_[order[n - 1]] != edges_[corner]) first = positions.size();
      std::size_t v = first;
      const auto is_far = [&] {
        const Vec3f way = positions_[corner] - positions[v];
        return dot(way, way) > within_mm * within_mm;
      };
      while (v < positions.size() && is_far()) ++v;
      if (v == positions.size()) {
        positions.push_back({0, 0, 0});
        origins.push_back({0, 0, 0});
        corners.push_back(0);
      }
      const float share = 1 / ++corners[v];
      positions[v] = positions[v] + share * (positions_[corner] - positions[v]);
      origins[v] = origins[v] + share * (origins_[corner] - origins[v]);
      vertex_of_[corner] = static_cast<std::uint32_t>(v);
    }
    positions_ = std::move(positions);
    origins_ = std::move(origins);
  }

  /// Replaces the positions of the meshes.
  void store() {
    constexpr auto kScale = static_cast<double>(kThickSliceScale);
    std::size_t corner = 0;
    for (SurfaceMesh* mesh : meshes_) {
      for (Vec3f& ijk : mesh->positions_ijk) {
        const auto& [x, y, z] = at(corner++);
        const Vec3 index = to_index_.apply_linear({x, y, z});
        for (std::size_t a = 0; a < 3; ++a) {
          const double within = std::clamp(index[a], -1.0, static_cast<double>(size_[a]));
          ijk[a] = static_cast<float>(std::round(within * kScale) / kScale);
        }
      }
      if (!mesh->empty()) mesh->position_scale = kThickSliceScale;
    }
  }

 private:
  [[nodiscard]] const Vec3f& at(std::size_t corner) const { return positions_[vertex_of_[corner]]; }

  template <typename Body>
  void for_each(std::size_t count, const Body& body) {
    constexpr std::size_t kAtOnce = 4096;
    pool_.for_each((count + kAtOnce - 1) / kAtOnce, [&](std::size_t part) {
      const std::size_t end = std::min(count, (part + 1) * kAtOnce);
      for (std::size_t n = part * kAtOnce; n < end; ++n) body(n);
    });
  }

  std::span<SurfaceMesh* const> meshes_;
  Index3 size_;
  Affine to_index_;
  ThreadPool pool_;
  std::vector<std::uint64_t> edges_;                     // [corner]: its voxel edge
  std::vector<std::uint32_t> vertex_of_;                 // [corner]
  std::vector<Vec3f> positions_, origins_;               // of vertices, mm from voxel (0, 0, 0): now, before
  std::vector<std::array<std::uint32_t, 3>> triangles_;  // of corners
  std::vector<Vec3f> facing_;                            // [triangle]: mean of the normals at its corners
  std::vector<float> trust_;                             // [triangle]: 0 to 1, by the length of that mean
};

}  // namespace

bool has_thick_slices(const Grid& grid) {
  const auto [thin, thick] = std::ranges::minmax(grid.spacing_mm);
  return thick > 2 * thin;
}

void smooth_across_slices(std::span<SurfaceMesh* const> meshes, const Grid& grid, unsigned threads,
                          const std::function<void(double)>& progress) {
  constexpr int kOwnSteps = 20, kJointSteps = 10;
  constexpr float kNear = 1.5f;  // shortest sides of a voxel
  if (std::ranges::all_of(meshes, [](const SurfaceMesh* mesh) { return mesh->empty(); })) return;
  const auto [thin, thick] = std::ranges::minmax(grid.spacing_mm);
  const auto reach_mm = static_cast<float>(thick / 2);
  JointSurfaces surfaces(meshes, grid, threads);
  const auto fit = [&](int first, int last) {
    surfaces.fit(last - first, reach_mm, [&](int step) {
      if (progress) progress(static_cast<double>(first + step) / (kOwnSteps + kJointSteps));
    });
  };
  fit(0, kOwnSteps);
  surfaces.join(kNear * static_cast<float>(thin));
  fit(kOwnSteps, kOwnSteps + kJointSteps);
  surfaces.store();
}

}  // namespace splatlas
