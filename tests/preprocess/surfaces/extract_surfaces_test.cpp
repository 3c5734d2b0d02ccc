#include "preprocess/surfaces/extract_surfaces.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/preprocess/random_images.h"
#include "tests/support/closed_mesh.h"

namespace splatlas {
namespace {

struct Extracted {
  ClassifiedVoxels classification;
  ExtractedSurfaces surfaces;
};

Extracted extract(const Masks& masks, const Grid& grid, unsigned threads = 2,
                  SurfaceRule rule = SurfaceRule::kSmooth) {
  const StructureGraph graph = flat_graph(masks.size());
  Extracted result{*classify_voxels(memberships_of(masks, grid.size), {}, graph, 1), {}};
  result.surfaces = value_or_throw(extract_surfaces(result.classification, graph, grid, {rule, threads, {}}));
  return result;
}

/// A rotation off the axes, right-handed or (mirrored) left-handed.
Matrix3 oblique(bool mirrored) {
  const double c = std::cos(0.3), s = std::sin(0.3), m = mirrored ? -1 : 1;
  return {m * c, -s, 0, m * s, c, 0, 0, 0, 1};
}

Vec3 position_mm(const Grid& grid, const SurfaceMesh& mesh, std::uint32_t vertex) {
  const auto& [i, j, k] = mesh.positions_ijk[vertex];
  return index_to_lps_mm(grid).apply({i, j, k});
}

TEST(ExtractSurfaces, TrianglesFaceOutwardsWhateverTheGrid) {
  for (const bool mirrored : {false, true}) {
    const Grid grid{.size = kPhantomSize, .spacing_mm = {0.5, 0.8, 2}, .direction_lps = oblique(mirrored)};
    const Extracted e = extract(phantom_masks(), grid);
    for (std::size_t n = 0; n < 2; ++n) {
      const SurfaceMesh& mesh = e.surfaces.surfaces[n];
      EXPECT_TRUE(is_closed(mesh.triangles));
      // A ball of voxels, within half a voxel at its rim.
      const double r = phantom::kBalls[n].radius;
      const auto corner = [&](std::uint32_t vertex) { return position_mm(grid, mesh, vertex); };
      EXPECT_NEAR(enclosed_volume(mesh.triangles, corner), 0.5 * 0.8 * 2 * 4 / 3 * M_PI * r * r * r,
                  0.05 * 0.8 * 4 / 3 * M_PI * r * r * r);
    }
  }
}

TEST(ExtractSurfaces, NormalsOfABallPointAwayFromItsCentre) {
  for (const bool mirrored : {false, true}) {
    const Grid grid{.size = {41, 41, 41}, .direction_lps = oblique(mirrored)};
    const Masks ball{make_mask(grid.size, [](auto i, auto j, auto k) {
      return (i - 20) * (i - 20) + (j - 20) * (j - 20) + (k - 20) * (k - 20) < 18 * 18;
    })};
    const Extracted e = extract(ball, grid);
    const SurfaceMesh& mesh = e.surfaces.surfaces[0];
    const Vec3 center = index_to_lps_mm(grid).apply({20, 20, 20});
    double sum = 0;
    for (std::uint32_t v = 0; v < mesh.positions_ijk.size(); ++v) {
      const Vec3 at = position_mm(grid, mesh, v);
      double along = 0, length = 0, unit = 0;
      for (std::size_t a = 0; a < 3; ++a) {
        along += (at[a] - center[a]) * mesh.normals_lps[v][a];
        length += (at[a] - center[a]) * (at[a] - center[a]);
        unit += mesh.normals_lps[v][a] * mesh.normals_lps[v][a];
      }
      EXPECT_NEAR(unit, 1, 1e-5);
      const double cosine = along / std::sqrt(length);
      EXPECT_GT(cosine, std::cos(15 * M_PI / 180));  // the steps of voxels, smoothed over one
      sum += cosine;
    }
    EXPECT_GT(sum / static_cast<double>(mesh.positions_ijk.size()), std::cos(5 * M_PI / 180));
  }
}

TEST(ExtractSurfaces, ThePlaneOfAnAnisotropicGridHasItsNormal) {
  // A half space along k, farther from the border of the grid than normals reach: 3 voxels, or 16 edges.
  for (const auto& [rule, border] :
       {std::pair{SurfaceRule::kVoxels, 4}, std::pair{SurfaceRule::kSmooth, 18}}) {
    const std::int64_t side = 2 * border + 8;
    const Grid grid{.size = {side, side, 16}, .spacing_mm = {1, 2, 5}, .direction_lps = oblique(true)};
    const Extracted e =
        extract({make_mask(grid.size, [](auto, auto, auto k) { return k < 8; })}, grid, 1, rule);
    const SurfaceMesh& mesh = e.surfaces.surfaces[0];
    std::size_t seen = 0;
    for (std::size_t v = 0; v < mesh.positions_ijk.size(); ++v) {
      const auto& [i, j, k] = mesh.positions_ijk[v];
      const auto low = static_cast<float>(border), high = static_cast<float>(border + 7);
      if (i < low || i > high || j < low || j > high || k < 7) continue;
      EXPECT_NEAR(mesh.normals_lps[v][2], 1, 1e-6);
      EXPECT_EQ(k, 7.5f);
      ++seen;
    }
    EXPECT_EQ(seen, 64u);
  }
}

TEST(ExtractSurfaces, ThickSlicesAreSmoothedAcross) {
  const auto rule = [](double thickness) {
    const Grid grid{.size = kPhantomSize, .spacing_mm = {1, 1, thickness}};
    return SurfaceRule{extract(phantom_masks(), grid).surfaces.surfaces[0].position_scale};
  };
  EXPECT_EQ(rule(1.21), SurfaceRule::kUneven);
  EXPECT_EQ(rule(1.2), SurfaceRule::kSmooth);
}

TEST(ExtractSurfaces, BoundaryNormalsStandInMemoryOrder) {
  // A slab: normals point down on its lower side, up on its upper side.
  int seen = 0;
  const Grid grid{.size = {9, 9, 9}};
  const Extracted e =
      extract({make_mask(grid.size, [](auto, auto, auto k) { return k >= 2 && k <= 6; })}, grid);
  const std::vector<ClassId> volume = volume_of(e.classification, grid.size);
  for (ClassId c = 0; c < e.classification.classes.size(); ++c) {
    std::size_t n = 0;
    for (std::size_t v = 0; v < volume.size(); ++v) {
      if (volume[v] != c || e.surfaces.boundary_normals[c].empty()) continue;
      const auto normal = unpack_normal(e.surfaces.boundary_normals[c][n++]);
      const auto i = static_cast<std::int64_t>(v % 9), j = static_cast<std::int64_t>(v / 9 % 9),
                 k = static_cast<std::int64_t>(v / 81);
      if (i != 4 || j != 4) continue;
      if (k == 2 || k == 6) {
        EXPECT_GT(normal[2] * (k == 2 ? -1 : 1), 0.99);
        ++seen;
      }
    }
  }
  EXPECT_EQ(seen, 2);
}

}  // namespace
}  // namespace splatlas
