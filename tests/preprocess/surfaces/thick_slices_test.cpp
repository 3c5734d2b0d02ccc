#include <algorithm>
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "format/derive/fit_surface.h"
#include "preprocess/surfaces/extract_surfaces.h"
#include "tests/format/derive/masks.h"
#include "tests/support/closed_mesh.h"

namespace splatlas {
namespace {

constexpr Index3 kSize{60, 60, 15};
const Grid kGrid{.size = kSize, .spacing_mm = {1, 1, 4}};
constexpr double kMiddle = 29.5, kMiddleSlice = 7;

/// A surface before and after smooth_across_slices().
struct Smoothed {
  SurfaceMesh before, after;
};

/// Of several structures.
std::vector<Smoothed> smooth(const std::vector<Mask>& masks, unsigned threads = 2) {
  std::vector<Smoothed> smoothed;
  for (const Mask& mask : masks) {
    SurfaceMesh mesh = fit_surface(crop_of(mask), kGrid, SurfaceRule::kSmooth);
    smoothed.push_back({mesh, mesh});
  }
  std::vector<SurfaceMesh*> meshes;
  for (Smoothed& of_mask : smoothed) meshes.push_back(&of_mask.after);
  smooth_across_slices(meshes, kGrid, threads);
  return smoothed;
}

/// Of the voxels with holds(x, y, z) in mm from the middle of the grid.
template <typename Holds>
Smoothed smooth(const Holds& holds) {
  return smooth({mask_of(kSize,
                         [&](auto i, auto j, auto k) {
                           return holds(static_cast<double>(i) - kMiddle, static_cast<double>(j) - kMiddle,
                                        4 * (static_cast<double>(k) - kMiddleSlice));
                         })})
      .front();
}

Vec3 mm(const std::array<float, 3>& ijk) {
  return {double{ijk[0]} - kMiddle, double{ijk[1]} - kMiddle, 4 * (double{ijk[2]} - kMiddleSlice)};
}

/// Root mean square over the vertices up to `reach` mm from the middle slice.
template <typename Distance>
double rms(const SurfaceMesh& mesh, double reach, const Distance& distance) {
  double sum = 0;
  int count = 0;
  for (const auto& ijk : mesh.positions_ijk) {
    const Vec3 at = mm(ijk);
    if (std::abs(at[2]) > reach) continue;
    const double mm_away = distance(at[0], at[1], at[2]);
    sum += mm_away * mm_away;
    ++count;
  }
  return std::sqrt(sum / count);
}

double enclosed_mm3(const SurfaceMesh& mesh) {
  return enclosed_volume(mesh.triangles,
                         [&](std::uint32_t vertex) { return mm(mesh.positions_ijk[vertex]); });
}

TEST(ThickSlices, ABallStaysABall) {
  const Smoothed ball = smooth([](double x, double y, double z) { return x * x + y * y + z * z < 400; });
  const auto distance = [](double x, double y, double z) { return std::sqrt(x * x + y * y + z * z) - 20; };
  EXPECT_LT(rms(ball.after, 99, distance), 1.01 * rms(ball.before, 99, distance));
  EXPECT_NEAR(enclosed_mm3(ball.after) / enclosed_mm3(ball.before), 1, 0.01);
  EXPECT_EQ(ball.after.triangles, ball.before.triangles);
  EXPECT_EQ(ball.after.normals_lps, ball.before.normals_lps);
}

TEST(ThickSlices, ContoursThatJumpFromSliceToSliceAreJoined) {
  const Smoothed tube = smooth([&](double x, double y, double z) {
    return std::hypot(x - 1.5 * std::sin(2.3 * z / 4), y) < 12 && std::abs(z) < 22;
  });
  const auto distance = [](double x, double y, double) { return std::hypot(x, y) - 12; };
  EXPECT_GT(rms(tube.before, 14, distance), 0.5);
  EXPECT_LT(rms(tube.after, 14, distance), 0.2);
  double farthest = 0;
  for (std::size_t v = 0; v < tube.after.positions_ijk.size(); ++v) {
    const Vec3 from = mm(tube.before.positions_ijk[v]), to = mm(tube.after.positions_ijk[v]);
    farthest = std::max(farthest, std::hypot(to[0] - from[0], to[1] - from[1], to[2] - from[2]));
  }
  EXPECT_GT(farthest, 1);
  EXPECT_LT(farthest, 2 + 4.0 / kThickSliceScale);  // half a slice, rounded
}

TEST(ThickSlices, VesselsAndSheetsKeepTheirSize) {
  for (const double slope : {0.0, 0.25}) {
    const Smoothed vessel = smooth(
        [&](double x, double y, double z) { return std::hypot(x - slope * z, y) < 1.6 && std::abs(z) < 22; });
    EXPECT_NEAR(enclosed_mm3(vessel.after) / enclosed_mm3(vessel.before), 1, 0.1) << slope;
    const Smoothed sheet = smooth([&](double x, double y, double z) {
      return std::abs(x - slope * z) <= 0.5 && std::abs(z) < 22 && std::abs(y) < 20;
    });
    EXPECT_NEAR(enclosed_mm3(sheet.after) / enclosed_mm3(sheet.before), 1, 0.08) << slope;
    const Smoothed across = smooth(
        [&](double x, double y, double z) { return std::abs(z + slope * x) <= 2 && std::hypot(x, y) < 22; });
    EXPECT_NEAR(enclosed_mm3(across.after) / enclosed_mm3(across.before), 1, 0.03) << slope;
  }
  // One voxel thick and two voxels farther in each slice: pieces that touch nowhere
  const Smoothed strips = smooth([&](double x, double y, double z) {
    return std::abs(x - z / 2) <= 0.5 && std::abs(z) < 22 && std::abs(y) < 20;
  });
  EXPECT_GT(enclosed_mm3(strips.after) / enclosed_mm3(strips.before), 0.8);
}

/// A tube in a wall of three voxels. From slope 0.65 on they meet on ledges between slices.
TEST(ThickSlices, NeighboursKeepTheirSize) {
  for (const double slope : {0.0, 0.3, 0.65, 1.0}) {
    for (const double gap : {0.0, 1.0, 2.0}) {
      const auto ring = [&](double from, double to) {
        return mask_of(kSize, [&](auto i, auto j, auto k) {
          const double z = 4 * (static_cast<double>(k) - kMiddleSlice);
          const double r =
              std::hypot(static_cast<double>(i) - kMiddle - slope * z, static_cast<double>(j) - kMiddle);
          return r >= from && r < to && std::abs(z) < 22;
        });
      };
      const std::vector<Mask> masks{ring(0, 5), ring(5 + gap, 8 + gap)};
      const std::vector<Smoothed> both = smooth(masks);
      for (std::size_t n = 0; n < 2; ++n) {
        const double alone = enclosed_mm3(smooth({masks[n]}).front().after);
        EXPECT_NEAR(enclosed_mm3(both[n].after) / alone, 1, gap > 0 ? 0.07 : 0.09)
            << n << " " << slope << " " << gap;
      }
    }
  }
}

TEST(ThickSlices, StructuresThatTouchShareTheirBorder) {
  const auto half = [&](double side) {
    return mask_of(kSize, [side](auto i, auto j, auto k) {
      const double x = static_cast<double>(i) - kMiddle, y = static_cast<double>(j) - kMiddle;
      const double z = 4 * (static_cast<double>(k) - kMiddleSlice);
      return x * x + y * y + z * z < 400 && side * (y - 2.2 * std::sin(2.3 * z / 4)) > 0;
    });
  };
  const std::vector<Smoothed> halves = smooth({half(1), half(-1)});
  // By the voxel edge of a vertex
  const auto edge = [](const std::array<float, 3>& ijk) {
    std::array<float, 6> low_high{};
    for (std::size_t a = 0; a < 3; ++a) {
      low_high[a] = std::floor(ijk[a]);
      low_high[3 + a] = std::ceil(ijk[a]);
    }
    return low_high;
  };
  std::map<std::array<float, 6>, std::array<float, 3>> of_first;
  const Smoothed &first = halves[0], &second = halves[1];
  for (std::size_t v = 0; v < first.before.positions_ijk.size(); ++v)
    of_first[edge(first.before.positions_ijk[v])] = first.after.positions_ijk[v];
  std::size_t shared = 0, common = 0;
  for (std::size_t v = 0; v < second.before.positions_ijk.size(); ++v) {
    const auto found = of_first.find(edge(second.before.positions_ijk[v]));
    if (found == of_first.end()) continue;
    ++shared;
    common += found->second == second.after.positions_ijk[v] ? 1 : 0;
  }
  EXPECT_GT(shared, 900u);
  EXPECT_GT(static_cast<double>(common) / static_cast<double>(shared), 0.9);
}

TEST(ThickSlices, DoNotDependOnTheOrigin) {
  SurfaceMesh near =
      fit_surface(crop_of(mask_of(kSize,
                                  [](auto i, auto j, auto k) {
                                    return (i - 30) * (i - 30) + (j - 30 + k) * (j - 30 + k) < 100 && k > 1;
                                  })),
                  kGrid, SurfaceRule::kSmooth);
  SurfaceMesh far = near;
  Grid far_grid = kGrid;
  far_grid.origin_lps_mm = {1e9, -1e9, 1e8};
  smooth_across_slices(std::array{&near}, kGrid, 1);
  smooth_across_slices(std::array{&far}, far_grid, 1);
  EXPECT_EQ(near, far);
}

TEST(ThickSlices, AreMoreThanTwiceAsThick) {
  EXPECT_TRUE(has_thick_slices(kGrid));
  EXPECT_TRUE(has_thick_slices({.size = kSize, .spacing_mm = {3.5, 1.5, 3}}));
  EXPECT_FALSE(has_thick_slices({.size = kSize, .spacing_mm = {1, 1, 2}}));
}

}  // namespace
}  // namespace splatlas
