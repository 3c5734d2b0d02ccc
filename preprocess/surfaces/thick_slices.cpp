#include "preprocess/surfaces/thick_slices.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "format/tasks/thread_pool.h"

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

/// The voxel edge of a vertex, as a number.
std::uint64_t edge_number(const Vec3f& position, const Grid& grid) {
  std::uint64_t number = 0, axis = 0;
  for (const std::size_t a : {2, 1, 0}) {
    const float low = std::floor(position[a]);
    if (low != position[a]) axis = a;
    number = number * static_cast<std::uint64_t>(grid.size[a] + 1) + static_cast<std::uint64_t>(low + 1);
  }
  return 3 * number + axis;
}

/// The surfaces of all structures on common vertices. Each structure has its own corners there.
class JointSurfaces {
 public:
  JointSurfaces(std::span<SurfaceMesh* const> meshes, const Grid& grid, unsigned threads)
      : meshes_(meshes), size_(grid.size), to_index_(lps_mm_to_index(grid)), pool_(threads) {
    number_vertices(grid);
    std::uint32_t first = 0;
    for (const SurfaceMesh* mesh : meshes_) {
      for (const auto& [a, b, c] : mesh->triangles) {
        const std::vector<Vec3f>& normals = mesh->normals_lps;
        const Vec3f sum = normals[a] + normals[b] + normals[c];
        facing_.push_back(unit(sum, normals[a]));
        agreement_.push_back(std::sqrt(dot(sum, sum)) / 3);
        triangles_.push_back({vertex_of_[first + a], vertex_of_[first + b], vertex_of_[first + c]});
      }
      first += static_cast<std::uint32_t>(mesh->positions_ijk.size());
    }
  }

  /// Moves all vertices towards the planes of the triangles around them, at most `reach_mm` in all.
  void fit(int steps, float reach_mm) {
    const Places uses(positions_.size(), std::span(triangles_.front().data(), 3 * triangles_.size()));
    std::vector<Vec3f> centres(triangles_.size()), moved(positions_.size());
    const std::vector<float> reach = reaches(uses, reach_mm);
    for (int step = 0; step < steps; ++step) {
      for_each(triangles_.size(), [&](std::size_t t) {
        const auto& [a, b, c] = triangles_[t];
        centres[t] = (1.0f / 3) * (positions_[a] + positions_[b] + positions_[c]);
      });
      for_each(positions_.size(), [&](std::size_t v) {
        Vec3f sum{0, 0, 0};
        for (const std::uint32_t use : uses.of(v)) {
          const Vec3f& n = facing_[use / 3];
          sum = sum + dot(n, centres[use / 3] - positions_[v]) * n;
        }
        const auto count = static_cast<float>(uses.of(v).size());
        const Vec3f way = positions_[v] + (1 / count) * sum - origins_[v];
        const float length = std::sqrt(dot(way, way));
        moved[v] = origins_[v] + std::min(1.0f, reach[v] / length) * way;
      });
      positions_.swap(moved);
    }
  }

  /// Replaces the positions of the meshes.
  void store() {
    constexpr auto kScale = static_cast<double>(kThickSliceScale);
    std::size_t corner = 0;
    for (SurfaceMesh* mesh : meshes_) {
      for (Vec3f& ijk : mesh->positions_ijk) {
        const auto& [x, y, z] = positions_[vertex_of_[corner++]];
        const Vec3 index = to_index_.apply({x, y, z});
        for (std::size_t a = 0; a < 3; ++a) {
          const double within = std::clamp(index[a], -1.0, static_cast<double>(size_[a]));
          ijk[a] = static_cast<float>(std::round(within * kScale) / kScale);
        }
      }
      if (!mesh->empty()) mesh->position_scale = kThickSliceScale;
    }
  }

 private:
  /// Vertices begin at the mean of their corners.
  void number_vertices(const Grid& grid) {
    std::vector<std::uint64_t> edges;
    for (const SurfaceMesh* mesh : meshes_) {
      for (const Vec3f& position : mesh->positions_ijk) edges.push_back(edge_number(position, grid));
    }
    std::vector<std::uint64_t> sorted = edges;
    std::ranges::sort(sorted);
    sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
    for (const std::uint64_t edge : edges)
      vertex_of_.push_back(
          static_cast<std::uint32_t>(std::ranges::lower_bound(sorted, edge) - sorted.begin()));
    const Affine to_lps = index_to_lps_mm(grid);
    std::vector<float> corners(sorted.size(), 0);
    positions_.assign(sorted.size(), {0, 0, 0});
    std::size_t corner = 0;
    for (const SurfaceMesh* mesh : meshes_) {
      for (const Vec3f& ijk : mesh->positions_ijk) {
        const std::uint32_t v = vertex_of_[corner++];
        const Vec3 mm = to_lps.apply({ijk[0], ijk[1], ijk[2]});
        for (std::size_t a = 0; a < 3; ++a) positions_[v][a] += static_cast<float>(mm[a]);
        ++corners[v];
      }
    }
    for (std::size_t v = 0; v < positions_.size(); ++v) positions_[v] = (1 / corners[v]) * positions_[v];
    origins_ = positions_;
  }

  /// [vertex]: how far it may move. Where normals turn from corner to corner, structures are as thin as
  /// voxels, and no plane is known.
  [[nodiscard]] std::vector<float> reaches(const Places& uses, float reach_mm) {
    constexpr float kNone = 0.8f, kWhole = 0.9f;
    std::vector<float> reach(positions_.size());
    for_each(positions_.size(), [&](std::size_t v) {
      float sum = 0;
      for (const std::uint32_t use : uses.of(v)) sum += agreement_[use / 3];
      const float mean = sum / static_cast<float>(uses.of(v).size());
      reach[v] = reach_mm * std::clamp((mean - kNone) / (kWhole - kNone), 0.0f, 1.0f);
    });
    return reach;
  }

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
  std::vector<Vec3f> positions_, origins_;               // of vertices, LPS mm: now, and before
  std::vector<std::uint32_t> vertex_of_;                 // [corner]
  std::vector<std::array<std::uint32_t, 3>> triangles_;  // of vertices
  std::vector<Vec3f> facing_;                            // [triangle]: mean of the normals at its corners
  std::vector<float> agreement_;                         // [triangle]: length of that mean
};

}  // namespace

bool has_thick_slices(const Grid& grid) {
  const auto [thin, thick] = std::ranges::minmax(grid.spacing_mm);
  return thick > 2 * thin;
}

void smooth_across_slices(std::span<SurfaceMesh* const> meshes, const Grid& grid, unsigned threads) {
  constexpr int kSteps = 30;
  if (std::ranges::all_of(meshes, [](const SurfaceMesh* mesh) { return mesh->empty(); })) return;
  JointSurfaces surfaces(meshes, grid, threads);
  surfaces.fit(kSteps, static_cast<float>(std::ranges::max(grid.spacing_mm) / 2));
  surfaces.store();
}

}  // namespace splatlas
