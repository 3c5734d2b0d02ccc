#include "player/page/visible_structures.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <vector>

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

constexpr double kMaxStep = 12;       // of depths, in pixels
constexpr int kPixelsPerWidth = 900;  // of the short side
constexpr float kOpaque = 0.95f;
constexpr float kDarkness = 0.75f;  // of a line

using Coverage = std::vector<float>;

/// 1 for pixels that differ from their right or lower neighbour, else 0.
Coverage edges_of(const Picture& picture, const IdImage& ids, const DepthMap& depths, double mm_per_pixel) {
  const auto width = static_cast<std::size_t>(ids.size.width),
             height = static_cast<std::size_t>(ids.size.height);
  const auto max_step = static_cast<float>(kMaxStep * mm_per_pixel);
  const auto differ = [&](std::size_t a, std::size_t b) {
    // Layers of translucent structures would cross their lines
    if (std::max(picture.rgba[4 * a + 3], picture.rgba[4 * b + 3]) < kOpaque) return false;
    const float step = std::abs(depths.mm[a] - depths.mm[b]);  // NaN between backgrounds
    return ids.numbers[a] != ids.numbers[b] || step > max_step;
  };
  Coverage edges(width * height);
  for (std::size_t y = 0; y < height; ++y) {
    for (std::size_t x = 0; x < width; ++x) {
      const std::size_t n = y * width + x;
      if ((x + 1 < width && differ(n, n + 1)) || (y + 1 < height && differ(n, n + width))) edges[n] = 1;
    }
  }
  return edges;
}

/// Replaces each value of a row or column by combine(values within `reach` before and behind it).
template <typename Combine>
Coverage filtered(const Coverage& from, std::size_t width, std::size_t step, int before, int behind,
                  const Combine& combine) {
  Coverage to(from.size());
  const std::size_t count = step == 1 ? width : from.size() / width;
  const std::size_t lines = from.size() / count;
  for (std::size_t line = 0; line < lines; ++line) {
    const std::size_t first = step == 1 ? line * width : line;
    for (std::size_t n = 0; n < count; ++n) {
      const auto at = static_cast<std::ptrdiff_t>(n), end = static_cast<std::ptrdiff_t>(count);
      float sum = 0;
      for (std::ptrdiff_t i = at - before; i <= at + behind; ++i)
        sum = combine(sum, i < 0 || i >= end ? 0 : from[first + static_cast<std::size_t>(i) * step], i - at);
      to[first + n * step] = sum;
    }
  }
  return to;
}

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

void draw_outlines(const IdImage& ids, const DepthMap& depths, double mm_per_pixel, Picture& picture) {
  const auto width = static_cast<std::size_t>(picture.size.width);
  Coverage lines = edges_of(picture, ids, depths, mm_per_pixel);

  // Widen them, and soften their edges
  const int wide = std::max(1, std::min(picture.size.width, picture.size.height) / kPixelsPerWidth);
  const auto largest = [](float a, float b, std::ptrdiff_t) { return std::max(a, b); };
  const auto tent = [](float sum, float value, std::ptrdiff_t away) {
    return sum + (away == 0 ? 0.5f : 0.25f) * value;
  };
  for (const std::size_t step : {std::size_t{1}, width}) {
    if (wide > 1) lines = filtered(lines, width, step, wide / 2, (wide - 1) / 2, largest);
    lines = filtered(lines, width, step, 1, 1, tent);
  }

  // A single line of pixels has a coverage of one half after the tent
  for (std::size_t n = 0; n < lines.size(); ++n) {
    const float dark = kDarkness * std::min(1.0f, 2 * lines[n]);
    float* const pixel = &picture.rgba[4 * n];
    for (std::size_t c = 0; c < 3; ++c) pixel[c] *= 1 - dark;
    pixel[3] += (1 - pixel[3]) * dark;
  }
}

}  // namespace splatlas
