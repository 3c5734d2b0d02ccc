#include <random>

#include <gtest/gtest.h>

#include "player/render/surfaces/screen_triangle.h"
#include "tests/support/every_kernel.h"

namespace splatlas {
namespace {

class RasterKernelsOf : public EveryKernel {
 protected:
  int number(int low, int high) { return std::uniform_int_distribution(low, high)(random_); }

  std::mt19937 random_{7};
};

constexpr std::size_t kVertices = 37;

/// Vertices with room for the padding of kernels.
struct Vertices {
  std::vector<std::int32_t> x = std::vector<std::int32_t>(kVertices + kRasterPadding), y = x;

  [[nodiscard]] SnappedVertices arrays() const { return {x.data(), y.data()}; }
  [[nodiscard]] ScreenVertex operator[](std::size_t n) const { return {x[n], y[n]}; }
};

TEST_P(RasterKernelsOf, SelectTrianglesWithPixelsInABox) {
  for (int scene = 0; scene < 200; ++scene) {
    Vertices vertices;
    for (std::size_t n = 0; n < kVertices; ++n) {
      vertices.x[n] = number(-4000, 20000);
      vertices.y[n] = number(-4000, 20000);
    }
    const PixelBox box{number(0, 20), number(10, 40), number(0, 20), number(10, 40)};
    const std::int32_t reach = scene % 2 == 0 ? 0 : kHalfPixel;
    std::vector<std::uint32_t> corners(45 + kRasterPadding), expected, out(corners.size());
    for (std::uint32_t n = 0; n < 45; ++n) {
      std::array<unsigned, 3> c{};
      for (unsigned& corner : c) corner = static_cast<unsigned>(number(0, kVertices - 1));
      corners[n] = c[0] | c[1] << 8 | c[2] << 16;
      if (!intersection(pixels_of(vertices[c[0]], vertices[c[1]], vertices[c[2]], reach), box).empty())
        expected.push_back(n);
    }
    out.resize(select_triangles(corners.data(), 45, vertices.arrays(), box, reach, out.data()));
    ASSERT_EQ(out, expected);
  }
}

TEST_P(RasterKernelsOf, CoverThePixelsInsideAllEdges) {
  for (int scene = 0; scene < 500; ++scene) {
    std::array<ScreenVertex, 3> v;
    for (ScreenVertex& vertex : v) vertex = {2560 + number(0, 32 * 256 - 1), -1280 + number(0, 32 * 256 - 1)};
    if (scene % 3 == 0) v[1].y = v[0].y;                        // an edge along a row
    if (scene % 5 == 0) v[2] = {v[2].x & ~255, v[2].y & ~255};  // a corner at a pixel centre
    const std::int64_t area = doubled_area(v[0], v[1], v[2]);
    if (area == 0) continue;
    const ScreenTriangle triangle(v, area);
    const PixelBox box = pixels_of(v[0], v[1], v[2], 0);
    const EdgeWalk walk(triangle, box.x_first, box.y_first);
    const std::int32_t columns = box.x_last - box.x_first + 1, rows = box.y_last - box.y_first + 1;
    if (columns < 1 || rows < 1) continue;
    std::vector<std::uint32_t> covered(static_cast<std::size_t>(rows));
    cover_pixels(walk.small(), columns, rows, covered.data());
    for (std::int32_t y = 0; y < rows; ++y) {
      for (std::int32_t x = 0; x < 32; ++x) {
        // Exact signs of the areas that the pixel centre spans with each edge
        const ScreenVertex center{(box.x_first + x) << 8, (box.y_first + y) << 8};
        bool inside = x < columns;
        for (std::size_t n = 0; n < 3; ++n) {
          const std::int64_t side =
              doubled_area(triangle.corner[(n + 1) % 3], triangle.corner[(n + 2) % 3], center);
          inside = inside && (side > 0 || (side == 0 && triangle.opened[n] == 0));
        }
        ASSERT_EQ(covered[static_cast<std::size_t>(y)] >> x & 1, inside ? 1 : 0)
            << scene << ": " << x << ", " << y;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Targets, RasterKernelsOf, testing::ValuesIn(kernel_targets()), kernel_name);

}  // namespace
}  // namespace splatlas
