#include "player/page/visible_structures.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>

namespace splatlas {
namespace {

/// Chamfer distances of neighbours, in thirds of a sample (Borgefors 1986).
constexpr int kEdge = 3, kCorner = 4;

/// Distance of each sample to the nearest one of another structure, in thirds of a sample. Samples beyond the
/// grid count as other structures.
std::vector<int> border_distances(const IdGrid& grid) {
  std::vector<int> distances(grid.ids.size(), 1 << 28);
  const auto index = [&](int i, int j) {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(grid.columns) + static_cast<std::size_t>(i);
  };
  const auto relax = [&](int i, int j, int di, int dj) {
    const std::size_t here = index(i, j);
    const int length = di != 0 && dj != 0 ? kCorner : kEdge;
    const int ni = i + di, nj = j + dj;
    const bool outside = ni < 0 || nj < 0 || ni >= grid.columns || nj >= grid.rows;
    const bool other = outside || grid.ids[index(ni, nj)] != grid.ids[here];
    distances[here] = std::min(distances[here], other ? length : distances[index(ni, nj)] + length);
  };
  for (int j = 0; j < grid.rows; ++j) {
    for (int i = 0; i < grid.columns; ++i) {
      relax(i, j, -1, -1), relax(i, j, 0, -1), relax(i, j, 1, -1), relax(i, j, -1, 0);
    }
  }
  for (int j = grid.rows - 1; j >= 0; --j) {
    for (int i = grid.columns - 1; i >= 0; --i) {
      relax(i, j, 1, 1), relax(i, j, 0, 1), relax(i, j, -1, 1), relax(i, j, 1, 0);
    }
  }
  return distances;
}

struct Region {
  double samples = 0, sum_x = 0, sum_y = 0;
  int deepest = 0;
  double nearest = 0;  // squared distance from the anchor to the centroid
  int i = -1, j = -1;  // anchor
};

}  // namespace

IdGrid sample_structures(const Picture& picture, const StructureAt& at, int max_samples) {
  const double area = static_cast<double>(picture.size.width) * picture.size.height;
  IdGrid grid;
  grid.step = std::max(1.0, std::sqrt(area / max_samples));
  grid.columns = std::max(1, static_cast<int>(picture.size.width / grid.step));
  grid.rows = std::max(1, static_cast<int>(picture.size.height / grid.step));
  grid.ids.reserve(static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows));
  for (int j = 0; j < grid.rows; ++j) {
    for (int i = 0; i < grid.columns; ++i) {
      const double x = (i + 0.5) * grid.step, y = (j + 0.5) * grid.step;
      const bool visible = picture.at(static_cast<int>(x), static_cast<int>(y))[3] >= 1.0f / 255;
      grid.ids.push_back(visible ? at(x, y) : kNoStructure);
    }
  }
  return grid;
}

std::vector<VisibleStructure> visible_structures(const IdGrid& grid) {
  // Sum up each structure's region
  const std::vector<int> distances = border_distances(grid);
  std::map<StructureIndex, Region> regions;
  const auto for_each = [&](const auto& visit) {
    std::size_t n = 0;
    for (int j = 0; j < grid.rows; ++j) {
      for (int i = 0; i < grid.columns; ++i, ++n) {
        if (grid.ids[n] != kNoStructure) visit(regions[grid.ids[n]], i, j, distances[n]);
      }
    }
  };
  for_each([](Region& region, int i, int j, int distance) {
    region.samples += 1, region.sum_x += i, region.sum_y += j;
    region.deepest = std::max(region.deepest, distance);
  });

  // Choose the deep sample nearest to the centroid
  for_each([](Region& region, int i, int j, int distance) {
    if (10 * distance < 9 * region.deepest) return;
    const double away =
        std::pow(i - region.sum_x / region.samples, 2) + std::pow(j - region.sum_y / region.samples, 2);
    if (region.i >= 0 && away >= region.nearest) return;
    region.nearest = away, region.i = i, region.j = j;
  });

  std::vector<VisibleStructure> structures;
  const double step = grid.step;
  for (const auto& [structure, region] : regions) {
    structures.push_back(
        {structure, region.samples * step * step, {(region.i + 0.5) * step, (region.j + 0.5) * step}});
  }
  return structures;
}

}  // namespace splatlas
