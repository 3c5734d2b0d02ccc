#include "player/page/visible_structures.h"

#include <algorithm>
#include <array>
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
  const PictureSize size{grid.columns, grid.rows};
  const auto relax = [&](int i, int j, int di, int dj) {
    const std::size_t here = size.pixel(i, j);
    const int length = di != 0 && dj != 0 ? kCorner : kEdge;
    const int ni = i + di, nj = j + dj;
    const bool outside = ni < 0 || nj < 0 || ni >= grid.columns || nj >= grid.rows;
    const bool other = outside || grid.ids[size.pixel(ni, nj)] != grid.ids[here];
    distances[here] = std::min(distances[here], other ? length : distances[size.pixel(ni, nj)] + length);
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

constexpr double kMaxStep = 12;  // of depths, in widths of a line
constexpr float kOpaque = 0.95f;
constexpr float kDarkness = 0.75f;  // of a line

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

void draw_outlines(const Picture& solids, const IdImage& ids, const DepthMap& depths, double mm_per_pixel,
                   double width, Picture& picture) {
  const auto columns = static_cast<std::size_t>(picture.size.width),
             rows = static_cast<std::size_t>(picture.size.height);
  width = std::max(width, 1.0);
  const auto is_opaque = [&](std::size_t n) {
    return n < columns * rows && solids.rgba[4 * n + 3] >= kOpaque;
  };
  const auto differ = [&](std::size_t a, std::size_t b) {
    // Layers of translucent structures would cross their lines; rims of opaque ones are antialiased
    const std::array around{a + a - b, a, b, b + b - a};
    if (std::ranges::none_of(around, is_opaque)) return false;
    const double step = std::abs(depths.mm[a] - depths.mm[b]);  // NaN between backgrounds
    return ids.numbers[a] != ids.numbers[b] || step > kMaxStep * width * mm_per_pixel;
  };

  // Shares of pixels that a disc covers which moves along the edges
  std::vector<float> covered(columns * rows);
  const auto reach = static_cast<std::size_t>(width / 2 + 1);
  const auto draw = [&](std::size_t x, std::size_t y, double to_right, double down) {
    for (std::size_t j = y - std::min(y, reach); j <= std::min(y + reach, rows - 1); ++j) {
      for (std::size_t i = x - std::min(x, reach); i <= std::min(x + reach, columns - 1); ++i) {
        const double away = std::hypot(static_cast<double>(i) - static_cast<double>(x) - to_right,
                                       static_cast<double>(j) - static_cast<double>(y) - down);
        const double share = std::clamp(0.5 * (width + 1) - away, 0.0, 1.0);
        covered[j * columns + i] = std::max(covered[j * columns + i], static_cast<float>(share));
      }
    }
  };
  for (std::size_t n = 0; n < covered.size(); ++n) {
    const std::size_t x = n % columns, y = n / columns;
    if (x + 1 < columns && differ(n, n + 1)) draw(x, y, 0.5, 0);
    if (y + 1 < rows && differ(n, n + columns)) draw(x, y, 0, 0.5);
  }

  for (std::size_t n = 0; n < covered.size(); ++n) {
    const float dark = kDarkness * covered[n];
    float* const pixel = &picture.rgba[4 * n];
    for (std::size_t c = 0; c < 3; ++c) pixel[c] *= 1 - dark;
    pixel[3] += (1 - pixel[3]) * dark;
  }
}

}  // namespace splatlas
