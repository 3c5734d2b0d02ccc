#include "player/render/decode/surface_clusters.h"

#include <cmath>

#include "format/tasks/task_control.h"

namespace splatlas {
namespace {

/// Cells of the Morton curve along the longest side of the mesh. More bits than the triangles of a cluster
/// need only cost time: those of a cell keep the order of the mesh, which is that of its rows of voxels.
constexpr int kBits = 7;
constexpr float kCells = 1 << kBits;
/// The curve has two digits for the sort.
constexpr int kDigitBits = 11;
static_assert(3 * kBits <= 2 * kDigitBits);

/// Maps normals of triangles in voxel indices to LPS: (M a) x (M b) = cofactors(M) (a x b).
class NormalMap {
 public:
  explicit NormalMap(const Grid& grid) {
    const Affine to_lps = index_to_lps_mm(grid);
    std::array<Vec3, 3> rows{};
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t c = 0; c < 3; ++c) rows[r][c] = to_lps.linear[3 * r + c];
    }
    for (std::size_t r = 0; r < 3; ++r) cofactors_[r] = cross(rows[(r + 1) % 3], rows[(r + 2) % 3]);
  }

  [[nodiscard]] SurfaceClusters::Front front_of(const SurfaceMesh& mesh,
                                                const std::array<std::uint32_t, 3>& corners) const {
    Vec3 first{}, second{}, front{};
    for (std::size_t a = 0; a < 3; ++a) {
      const double origin = mesh.positions_ijk[corners[0]][a];
      first[a] = mesh.positions_ijk[corners[1]][a] - origin;
      second[a] = mesh.positions_ijk[corners[2]][a] - origin;
      for (const std::uint32_t corner : corners) front[a] += static_cast<double>(mesh.normals_lps[corner][a]);
    }
    const Vec3 normal = cross(first, second);
    const double to_front =
        dot({dot(cofactors_[0], normal), dot(cofactors_[1], normal), dot(cofactors_[2], normal)}, front);
    if (!(std::abs(to_front) > 0)) return SurfaceClusters::Front::kBoth;
    return std::signbit(to_front) ? SurfaceClusters::Front::kClockwise
                                  : SurfaceClusters::Front::kCounterClockwise;
  }

 private:
  std::array<Vec3, 3> cofactors_{};
};

void include(const std::array<float, 3>& p, SurfaceClusters::Box& box) {
  for (std::size_t a = 0; a < 3; ++a) {
    if (!std::isfinite(p[a])) continue;
    box.low[a] = std::min(box.low[a], p[a]);
    box.high[a] = std::max(box.high[a], p[a]);
  }
}

/// Places of the centres of triangles on a Morton curve through the bounding box.
class MortonCurve {
 public:
  explicit MortonCurve(const SurfaceMesh& mesh) : mesh_(mesh) {
    SurfaceClusters::Box box;
    for (const std::array<float, 3>& p : mesh.positions_ijk) include(p, box);
    low_ = box.low;
    float side = 0;
    for (std::size_t a = 0; a < 3; ++a) side = std::max(side, box.high[a] - box.low[a]);
    per_voxel_ = side > 0 ? kCells / side : 0;
  }

  [[nodiscard]] std::uint32_t place(const std::array<std::uint32_t, 3>& corners) const {
    std::uint32_t place = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      float sum = 0;
      for (const std::uint32_t corner : corners) sum += mesh_.positions_ijk[corner][a];
      const float cell = (sum / 3 - low_[a]) * per_voxel_;
      place |= spread(cell > 0 ? static_cast<std::uint32_t>(std::min(cell, kCells - 1)) : 0) << a;
    }
    return place;
  }

 private:
  /// Moves bit n to bit 3 n.
  static std::uint32_t spread(std::uint32_t bits) {
    bits = (bits | bits << 16) & 0x030000ff;
    bits = (bits | bits << 8) & 0x0300f00f;
    bits = (bits | bits << 4) & 0x030c30c3;
    return (bits | bits << 2) & 0x09249249;
  }

  const SurfaceMesh& mesh_;
  std::array<float, 3> low_{};
  float per_voxel_ = 0;
};

/// True if the edges of all triangles cancel out: each runs as often to and fro. Compares sums of hashes.
bool has_no_border(const SurfaceMesh& mesh) {
  const auto hash = [](std::uint64_t from, std::uint64_t to) {
    std::uint64_t mixed = (std::min(from, to) << 32 | std::max(from, to)) * 0x9e3779b97f4a7c15;
    mixed = (mixed ^ mixed >> 32) * 0xd6e8feb86659fd93;
    mixed ^= mixed >> 32;
    return from < to ? mixed : -mixed;
  };
  std::uint64_t sum = 0;
  for (const auto& [a, b, c] : mesh.triangles) sum += hash(a, b) + hash(b, c) + hash(c, a);
  return sum == 0;
}

bool is_fitted(const SurfaceMesh& mesh) {
  return mesh.position_scale == static_cast<std::uint32_t>(SurfaceRule::kVoxels) ||
         mesh.position_scale == static_cast<std::uint32_t>(SurfaceRule::kSmooth);
}

/// True if corners are counter-clockwise from outside. Normals are means over several triangles, and may
/// point to the other side of a small one.
bool is_wound_outwards(const SurfaceMesh& mesh) {
  return is_fitted(mesh) || mesh.position_scale == static_cast<std::uint32_t>(SurfaceRule::kUneven);
}

/// Numbers of the triangles along the curve, by a radix sort. Neighbours in a cell keep their order.
std::vector<std::uint32_t> sorted_triangles(const SurfaceMesh& mesh) {
  struct Placed {
    std::uint32_t place, triangle;
  };
  const MortonCurve curve(mesh);
  std::vector<Placed> from(mesh.triangles.size()), to(from.size());
  for (std::uint32_t n = 0; n < from.size(); ++n) from[n] = {curve.place(mesh.triangles[n]), n};
  for (int digit = 0; digit < 2; ++digit) {
    check_task();
    const auto digit_of = [digit](const Placed& placed) {
      return (placed.place >> (kDigitBits * digit)) & ((1u << kDigitBits) - 1);
    };
    std::array<std::uint32_t, (1u << kDigitBits) + 1> first{};
    for (const Placed& placed : from) ++first[digit_of(placed) + 1];
    for (std::size_t n = 1; n < first.size(); ++n) first[n] += first[n - 1];
    for (const Placed& placed : from) to[first[digit_of(placed)]++] = placed;
    from.swap(to);
  }
  std::vector<std::uint32_t> numbers(from.size());
  std::transform(from.begin(), from.end(), numbers.begin(), [](const Placed& of) { return of.triangle; });
  return numbers;
}

}  // namespace

SurfaceClusters::SurfaceClusters(const SurfaceMesh& mesh, const Grid& grid)
    : is_closed_(is_fitted(mesh) && has_no_border(mesh)) {
  // Most clusters have fewer vertices than triangles
  constexpr double kBytesPerTriangle = 34 + 16 + 2;
  check_memory(kBytesPerTriangle * static_cast<double>(mesh.triangles.size()));
  numbers_ = sorted_triangles(mesh);
  const NormalMap normals(grid);
  // Of each vertex the latest cluster with it, and its place there: most are in two clusters
  constexpr std::uint32_t kNowhere = 0xffffffff, kPlaceBits = 8;
  std::vector<std::uint32_t> place_of(mesh.positions_ijk.size(), kNowhere);
  triangles_.resize(numbers_.size());
  // Rarely exceeded; pages that remain unused take no memory
  positions_.reserve(numbers_.size() + 3 * kMaxTriangles);
  normals_.reserve(numbers_.size() + 3 * kMaxTriangles);
  // Neighbours along the curve are scattered in the mesh
  constexpr std::size_t kAhead = 16;
  const auto prefetch = [&](std::size_t n) {
    if (n + 2 * kAhead >= numbers_.size()) return;
    __builtin_prefetch(&mesh.triangles[numbers_[n + 2 * kAhead]]);
    for (const std::uint32_t corner : mesh.triangles[numbers_[n + kAhead]]) {
      __builtin_prefetch(&place_of[corner]);
      __builtin_prefetch(&mesh.positions_ijk[corner]);
      __builtin_prefetch(&mesh.normals_lps[corner]);
    }
  };
  TaskPace pace;
  for (std::uint32_t n = 0; n < numbers_.size(); ++n) {
    pace.step();
    if (n % kMaxTriangles == 0) {
      if (n > 0) first_vertex_.push_back(static_cast<std::uint32_t>(positions_.size()));
      boxes_.emplace_back();
    }
    prefetch(n);
    const auto cluster = static_cast<std::uint32_t>(n / kMaxTriangles);
    const std::array<std::uint32_t, 3>& corners = mesh.triangles[numbers_[n]];
    Triangle& triangle = triangles_[n];
    triangle.front = is_wound_outwards(mesh) ? Front::kCounterClockwise : normals.front_of(mesh, corners);
    for (std::size_t c = 0; c < 3; ++c) {
      std::uint32_t& place = place_of[corners[c]];
      if (place == kNowhere || place >> kPlaceBits != cluster) {
        place = cluster << kPlaceBits | static_cast<std::uint32_t>(positions_.size() - first_vertex_.back());
        positions_.push_back(mesh.positions_ijk[corners[c]]);
        normals_.push_back(mesh.normals_lps[corners[c]]);
        include(positions_.back(), boxes_.back());
      }
      triangle.corners[c] = static_cast<std::uint8_t>(place);
    }
  }
  if (!numbers_.empty()) first_vertex_.push_back(static_cast<std::uint32_t>(positions_.size()));
}

}  // namespace splatlas
