// Outlines of solids in a plane: winding numbers against closed forms.
#include "player/render/clip/solid_outlines.h"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/repetitions.h"

namespace splatlas {
namespace {

/// A sphere of rings from pole to pole, within radius^2 / rings^2 of the exact one.
SurfaceMesh ringed_sphere(const Vec3& center, double radius, std::uint32_t rings) {
  SurfaceMesh mesh;
  const std::uint32_t columns = 2 * rings;
  for (std::uint32_t ring = 0; ring <= rings; ++ring) {
    for (std::uint32_t column = 0; column < columns; ++column) {
      const double polar = std::numbers::pi * ring / rings, around = 2 * std::numbers::pi * column / columns;
      const double across = ring == 0 || ring == rings ? 0 : radius * std::sin(polar);
      mesh.positions_ijk.push_back({static_cast<float>(center[0] + across * std::cos(around)),
                                    static_cast<float>(center[1] + across * std::sin(around)),
                                    static_cast<float>(center[2] + radius * std::cos(polar))});
    }
  }
  for (std::uint32_t ring = 0; ring < rings; ++ring) {
    for (std::uint32_t column = 0; column < columns; ++column) {
      const std::uint32_t next = (column + 1) % columns, here = ring * columns, below = here + columns;
      mesh.triangles.push_back({here + column, below + column, below + next});
      mesh.triangles.push_back({here + column, below + next, here + next});
    }
  }
  return mesh;
}

std::uint32_t solid_at(const SolidOutlines& outlines, double b, double c) {
  return outlines.at(outlines.cell(std::llround(std::floor(b)), std::llround(std::floor(c))), b, c);
}

/// A plane through `point`, with a normal whose largest component is that of axis 2.
VoxelPlane random_plane(std::mt19937& random, const Vec3& point) {
  const auto within = [&](double low, double high) {
    return low + (high - low) * std::generate_canonical<double, 32>(random);
  };
  VoxelPlane plane{{within(-1, 1), within(-1, 1), random() % 2 == 0 ? 1.0 : -1.0}, 0};
  const double length = std::hypot(plane.normal[0], plane.normal[1], plane.normal[2]);
  for (double& component : plane.normal) component /= length;
  plane.offset = plane.normal[0] * point[0] + plane.normal[1] * point[1] + plane.normal[2] * point[2];
  return plane;
}

/// Position along axis 2 of a point of the plane.
double height(const VoxelPlane& plane, double b, double c) {
  return (plane.offset - plane.normal[0] * b - plane.normal[1] * c) / plane.normal[2];
}

struct Ball {
  Vec3 center;
  double radius;
};

/// Distance to the sphere; negative inside.
double gap(const Ball& ball, double b, double c, double a) {
  return std::hypot(b - ball.center[0], c - ball.center[1], a - ball.center[2]) - ball.radius;
}

TEST(SolidOutlines, EnclosePointsOfSpheres) {
  constexpr double kTolerance = 0.03;
  ThreadPool pool(2);
  std::size_t inside = 0, compared = 0;
  for (std::uint32_t seed = 0; seed < repetitions(60); ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const auto within = [&](double low, double high) {
      return low + (high - low) * std::generate_canonical<double, 32>(random);
    };
    std::vector<Ball> balls;
    std::vector<SurfaceMesh> meshes;
    for (std::uint32_t n = 0; n < 1 + seed % 4; ++n) {
      const bool aligned = seed % 3 == 0;  // on lattice points
      Ball ball{{within(-4, 9), within(-4, 9), within(-4, 9)}, within(0.3, 6)};
      if (aligned) {
        for (double& place : ball.center) place = std::round(2 * place) / 2;
        ball.radius = std::ceil(ball.radius);
      }
      balls.push_back(ball);
      meshes.push_back(ringed_sphere(ball.center, ball.radius, 40));
      if (random() % 2 == 0) {  // inside out
        for (auto& triangle : meshes.back().triangles) std::swap(triangle[0], triangle[1]);
      }
    }
    std::vector<const SurfaceMesh*> solids;
    for (const SurfaceMesh& mesh : meshes) solids.push_back(&mesh);
    VoxelPlane plane = random_plane(random, balls[0].center);
    if (seed % 5 == 0) plane = {{0, 0, 1}, balls[0].center[2]};
    const SolidOutlines outlines(plane, 0, 1, solids, pool);
    for (std::uint32_t n = 0; n < balls.size(); ++n) EXPECT_TRUE(outlines.is_closed(n));

    for (int point = 0; point < 3000; ++point) {
      double b = within(-12, 16), c = within(-12, 16);
      if (point % 3 == 0) b = std::round(4 * b) / 4, c = std::round(4 * c) / 4;
      const double a = height(plane, b, c);
      std::uint32_t expected = SolidOutlines::kNone;
      bool is_near = false;
      for (std::uint32_t n = 0; n < balls.size(); ++n) {
        const double distance = gap(balls[n], b, c, a);
        is_near = is_near || std::abs(distance) < kTolerance;
        if (distance < 0) expected = n;
      }
      if (is_near) continue;
      ++compared;
      inside += expected != SolidOutlines::kNone ? 1 : 0;
      ASSERT_EQ(solid_at(outlines, b, c), expected) << b << ", " << c;
    }
  }
  EXPECT_GT(inside, compared / 20);
}

TEST(SolidOutlines, AreOpenWhereATriangleIsMissing) {
  ThreadPool pool(1);
  const SurfaceMesh whole = ringed_sphere({5, 5, 5}, 3, 20);
  SurfaceMesh open = whole;
  // Triangles of the ring at the equator
  std::erase_if(open.triangles, [&](const auto& triangle) { return triangle[0] == 10 * 40; });
  const std::array<const SurfaceMesh*, 2> solids{&whole, &open};
  const SolidOutlines across({{0, 0, 1}, 4.9}, 0, 1, solids, pool);
  EXPECT_TRUE(across.is_closed(0));
  EXPECT_FALSE(across.is_closed(1));
  EXPECT_EQ(solid_at(across, 5, 5), 0u);
  const SolidOutlines above({{0, 0, 1}, 7.1}, 0, 1, solids, pool);
  EXPECT_TRUE(above.is_closed(1)) << "the plane does not cross the hole";
  EXPECT_EQ(solid_at(above, 5, 5), 1u);
}

TEST(SolidOutlines, OfNothingEncloseNothing) {
  ThreadPool pool(1);
  EXPECT_EQ(solid_at({}, 0, 0), SolidOutlines::kNone);
  const SurfaceMesh empty;
  const std::array<const SurfaceMesh*, 1> solids{&empty};
  const SolidOutlines outlines({{1, 0, 0}, 2}, 1, 2, solids, pool);
  EXPECT_TRUE(outlines.is_closed(0));
  EXPECT_EQ(solid_at(outlines, 3, 4), SolidOutlines::kNone);
}

}  // namespace
}  // namespace splatlas
