#include "preprocess/import/meshes/surround_meshes.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace splatlas {
namespace {

struct Box {
  Vec3 low{}, high{};
};

/// The box of all points, mapped by `place`.
template <typename Place>
Box box_of_points(std::span<const TriangleMesh> meshes, const Place& place) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  Box box{{kInfinite, kInfinite, kInfinite}, {-kInfinite, -kInfinite, -kInfinite}};
  for (const TriangleMesh& mesh : meshes) {
    for (const auto& triangle : mesh.triangles) {
      for (const std::uint32_t corner : triangle) {
        const Vec3 at = place(mesh.positions_lps_mm[corner]);
        for (std::size_t a = 0; a < 3; ++a) {
          box.low[a] = std::min(box.low[a], at[a]);
          box.high[a] = std::max(box.high[a], at[a]);
        }
      }
    }
  }
  return box;
}

}  // namespace

Margin margin_for(const Grid& grid, std::span<const TriangleMesh> meshes) {
  const Affine to_index = lps_mm_to_index(grid);
  const Box box = box_of_points(meshes, [&](const Vec3& mm) { return to_index.apply(mm); });
  Margin margin;
  for (std::size_t a = 0; a < 3; ++a) {
    const double first = std::floor(box.low[a] + 0.5) - 1, last = std::ceil(box.high[a] - 0.5) + 1;
    const auto end = static_cast<double>(grid.size[a] - 1);
    constexpr double kMost = static_cast<double>(kMaxAxisSize);
    if (first < 0 && box.low[a] < -0.5) margin.low[a] = static_cast<std::int64_t>(std::min(-first, kMost));
    if (last > end && box.high[a] > end + 0.5)
      margin.high[a] = static_cast<std::int64_t>(std::min(last - end, kMost));
  }
  return margin;
}

Grid grid_around(std::span<const TriangleMesh> meshes) {
  constexpr double kVoxels = 256;
  const Box box = box_of_points(meshes, [](const Vec3& mm) { return mm; });
  double longest = 0;
  for (std::size_t a = 0; a < 3; ++a) longest = std::max(longest, box.high[a] - box.low[a]);
  const double spacing = std::max(longest / kVoxels, kMinSpacingMm);
  Grid grid;
  grid.spacing_mm = {spacing, spacing, spacing};
  for (std::size_t a = 0; a < 3; ++a) {
    grid.size[a] = static_cast<std::int64_t>(std::floor((box.high[a] - box.low[a]) / spacing)) + 3;
    grid.origin_lps_mm[a] = box.low[a] - spacing;
  }
  return grid;
}

}  // namespace splatlas
