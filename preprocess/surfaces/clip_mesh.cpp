#include "preprocess/surfaces/clip_mesh.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <unordered_map>

#include "format/content/unit_vector.h"
#include "format/result_macros.h"

namespace splatlas {
namespace {

constexpr std::uint32_t kPositionScale = 1024;
constexpr std::size_t kMaxPieces = std::size_t{1} << 26;

struct Corner {
  Vec3 index;  ///< continuous voxel indices, multiples of 1 / kPositionScale
  std::array<float, 3> normal;
};
using Polygon = std::vector<Corner>;  ///< convex

double quantized(double x) {
  return std::round(x * kPositionScale) / kPositionScale;
}

/// Intersection of an edge with a plane, alike for both directions: adjacent triangles share vertices.
Corner cut_edge(const Corner& from, const Corner& to, std::size_t axis, double plane) {
  const bool forwards = from.index < to.index;
  const Corner &a = forwards ? from : to, &b = forwards ? to : from;
  const double t = (plane - a.index[axis]) / (b.index[axis] - a.index[axis]);
  Corner cut;
  for (std::size_t n = 0; n < 3; ++n) {
    cut.index[n] = quantized(a.index[n] + t * (b.index[n] - a.index[n]));
    cut.normal[n] = a.normal[n] + static_cast<float>(t) * (b.normal[n] - a.normal[n]);
  }
  cut.index[axis] = plane;
  return cut;
}

/// Splits a convex polygon at a plane. Corners in the plane belong to both parts; polygons in it are `above`.
void cut_polygon(const Polygon& polygon, std::size_t axis, double plane, Polygon& below, Polygon& above) {
  below.clear();
  above.clear();
  bool any_below = false, any_above = false;
  for (std::size_t n = 0; n < polygon.size(); ++n) {
    const Corner &corner = polygon[n], &next = polygon[(n + 1) % polygon.size()];
    const double here = corner.index[axis] - plane, there = next.index[axis] - plane;
    any_below = any_below || here < 0;
    any_above = any_above || here > 0;
    if (here <= 0) below.push_back(corner);
    if (here >= 0) above.push_back(corner);
    if ((here < 0 && there > 0) || (here > 0 && there < 0)) {
      const Corner cut = cut_edge(corner, next, axis, plane);
      below.push_back(cut);
      above.push_back(cut);
    }
  }
  if (!any_below) below.clear();
  if (!any_above && any_below) above.clear();
}

/// A triangle with vertex indices of the surface, and the first voxel that it crosses.
struct Piece {
  std::int64_t voxel;
  std::array<std::uint32_t, 3> corners;
};

class MeshClipper {
 public:
  explicit MeshClipper(const Grid& grid)
      : grid_(grid), to_mm_(index_to_lps_mm(grid)), to_index_(lps_mm_to_index(grid)) {}

  Result<ClippedMesh> clip(const TriangleMesh& mesh) {
    const auto normals = mesh.normals_lps.empty() ? corner_normals(mesh) : std::vector<CornerNormals>();
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      Polygon polygon;
      for (std::size_t n = 0; n < 3; ++n) {
        const std::uint32_t v = mesh.triangles[t][n];
        polygon.push_back({to_index_.apply(mesh.positions_lps_mm[v]),
                           normals.empty() ? mesh.normals_lps[v] : normals[t][n]});
      }
      total_area_ += area_of(polygon);
      clip_to_grid(polygon);
      kept_area_ += area_of(polygon);
      for (Corner& corner : polygon) {
        for (double& x : corner.index) x = quantized(x);
      }
      const std::size_t first = crossed_.size();
      split(polygon, 0, {0, 0, 0});
      if (crossed_.size() > kMaxPieces)
        return fail(ErrorCode::kLimit, "its triangles cross more than {} voxels", kMaxPieces);
      if (crossed_.size() > first) emit(polygon, *std::min_element(&crossed_[first], &crossed_.back() + 1));
    }
    return finish();
  }

 private:
  [[nodiscard]] double area_of(const Polygon& polygon) const {
    Vec3 sum{0, 0, 0};
    for (std::size_t n = 2; n < polygon.size(); ++n) {
      const Vec3 u = difference(polygon[n - 1].index, polygon[0].index);
      const Vec3 v = difference(polygon[n].index, polygon[0].index);
      const Vec3 normal = cross(to_mm_.apply_linear(u), to_mm_.apply_linear(v));
      for (std::size_t a = 0; a < 3; ++a) sum[a] += normal[a];
    }
    return 0.5 * std::hypot(sum[0], sum[1], sum[2]);
  }

  /// Call before quantization, to prevent integer overflow of distant corners.
  void clip_to_grid(Polygon& polygon) {
    for (std::size_t a = 0; a < 3 && !polygon.empty(); ++a) {
      cut_polygon(polygon, a, -0.5, below_[a], above_[a]);
      polygon = above_[a];
      if (polygon.empty()) return;
      const double end = static_cast<double>(grid_.size[a]) - 0.5;
      const bool reaches_beyond = std::any_of(polygon.begin(), polygon.end(),
                                              [&](const Corner& corner) { return corner.index[a] > end; });
      if (!reaches_beyond) continue;
      cut_polygon(polygon, a, end, below_[a], above_[a]);
      polygon = below_[a];
    }
  }

  /// Collects the voxels of a polygon: splits it recursively along `axis` and the following axes; `voxel` has
  /// the indices of the preceding axes.
  void split(Polygon& polygon, std::size_t axis, Index3 voxel) {
    if (polygon.size() < 3) return;
    if (axis == 3 && area_of(polygon) > 0) crossed_.push_back(voxel_of(polygon, voxel));
    if (axis == 3) return;
    const auto [low, high] =
        std::minmax_element(polygon.begin(), polygon.end(),
                            [&](const auto& a, const auto& b) { return a.index[axis] < b.index[axis]; });
    const std::int64_t last_of_grid = grid_.size[axis] - 1;
    const auto first = std::min(static_cast<std::int64_t>(std::floor(low->index[axis] + 0.5)), last_of_grid);
    const auto last =
        std::clamp(static_cast<std::int64_t>(std::ceil(high->index[axis] - 0.5)), first, last_of_grid);
    Polygon rest = polygon, below, above;
    for (voxel[axis] = first; voxel[axis] < last; ++voxel[axis]) {
      cut_polygon(rest, axis, static_cast<double>(voxel[axis]) + 0.5, below, above);
      split(below, axis + 1, voxel);
      std::swap(rest, above);
    }
    split(rest, axis + 1, voxel);
  }

  /// The voxel of a part. Quantization may move it into the plane of the next voxel, its own then.
  [[nodiscard]] std::int64_t voxel_of(const Polygon& part, Index3 voxel) const {
    for (std::size_t a = 0; a < 3; ++a) {
      const double plane = static_cast<double>(voxel[a]) + 0.5;
      const bool in_plane = std::all_of(part.begin(), part.end(),
                                        [&](const Corner& corner) { return corner.index[a] >= plane; });
      if (in_plane && voxel[a] + 1 < grid_.size[a]) ++voxel[a];
    }
    return grid_.offset(voxel[0], voxel[1], voxel[2]);
  }

  /// Triangulates a polygon as a fan. Drops triangles without area after quantization.
  void emit(const Polygon& polygon, std::int64_t voxel) {
    for (std::size_t n = 2; n < polygon.size(); ++n) {
      const Polygon triangle{polygon[0], polygon[n - 1], polygon[n]};
      if (!(area_of(triangle) > 0)) continue;
      pieces_.push_back({voxel, {number(triangle[0]), number(triangle[1]), number(triangle[2])}});
    }
  }

  /// Vertex index of a corner. Merges corners with equal positions and equal packed normals.
  std::uint32_t number(const Corner& corner) {
    Key key{};
    for (std::size_t a = 0; a < 3; ++a) key[a] = std::lround(corner.index[a] * kPositionScale);
    key[3] = pack_normal(corner.normal);
    const auto [entry, is_new] = number_of_.try_emplace(key, static_cast<std::uint32_t>(corners_.size()));
    if (is_new) corners_.push_back(corner);
    return entry->second;
  }

  ClippedMesh finish() {
    std::stable_sort(pieces_.begin(), pieces_.end(),
                     [](const auto& a, const auto& b) { return a.voxel < b.voxel; });
    ClippedMesh result;
    result.surface.position_scale = kPositionScale;
    result.outside = total_area_ > 0 ? std::max(0.0, 1 - kept_area_ / total_area_) : 0;
    for (const Corner& corner : corners_) {
      const auto& [i, j, k] = corner.index;
      result.surface.positions_ijk.push_back(
          {static_cast<float>(i), static_cast<float>(j), static_cast<float>(k)});
      const auto& [x, y, z] = corner.normal;
      const float length = std::hypot(x, y, z);
      result.surface.normals_lps.push_back(length > 0 ? std::array{x / length, y / length, z / length}
                                                      : std::array{0.f, 0.f, 1.f});
    }
    for (const Piece& piece : pieces_) result.surface.triangles.push_back(piece.corners);
    std::ranges::sort(crossed_);
    std::ranges::unique_copy(crossed_, std::back_inserter(result.crossed));
    return result;
  }

  using Key = std::array<std::int64_t, 4>;
  struct KeyHash {
    std::size_t operator()(const Key& key) const {
      std::uint64_t hash = 0;
      for (const std::int64_t part : key)
        hash = (hash ^ static_cast<std::uint64_t>(part)) * 0x9e3779b97f4a7c15u;
      return hash ^ hash >> 32;
    }
  };

  const Grid& grid_;
  Affine to_mm_, to_index_;
  std::array<Polygon, 3> below_, above_;
  double total_area_ = 0, kept_area_ = 0;
  std::vector<Piece> pieces_;
  std::vector<std::int64_t> crossed_;  // once for each triangle
  std::vector<Corner> corners_;
  std::unordered_map<Key, std::uint32_t, KeyHash> number_of_;
};

}  // namespace

Result<ClippedMesh> clip_mesh(const TriangleMesh& mesh, const Grid& grid) {
  return MeshClipper(grid).clip(mesh);
}

}  // namespace splatlas
