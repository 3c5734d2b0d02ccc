#include "player/render/surfaces/rasterize.h"

#include <list>
#include <map>
#include <random>
#include <utility>

#include <gtest/gtest.h>

#include "tests/reference/reference_radiance.h"
#include "tests/support/marching_tetrahedra.h"
#include "tests/support/test_content.h"

namespace splatlas {
namespace {

/// A view with pixels `mm_per_pixel` wide around `center_lps_mm`.
ParallelView view_from(double azimuth_deg, double elevation_deg, PictureSize size, double mm_per_pixel,
                       const Vec3& center_lps_mm) {
  const Camera camera{
      .azimuth_deg = azimuth_deg, .elevation_deg = elevation_deg, .center_lps_mm = center_lps_mm};
  ParallelView view = *parallel_view(camera, size, Display{});
  view.mm_per_pixel = mm_per_pixel;
  return view;
}

struct PixelFragment : Fragment {
  std::uint32_t pixel = 0;
};

/// A fragment list, and the pixel of every fragment.
struct Drawn {
  std::vector<PixelFragment> fragments;

  Drawn(const FragmentList& list, const PictureSize& size) {
    for (std::size_t n = 0; n < list.sample_count(); ++n) {
      for (const Fragment& fragment : list.of_sample(n)) {
        fragments.push_back({fragment, list.samples[n].pixel});
      }
    }
    EXPECT_EQ(list.first_of_row.front(), 0u);
    EXPECT_EQ(list.first_of_row.back(), list.sample_count());
    for (std::uint32_t y = 0; y < static_cast<std::uint32_t>(size.height); ++y) {
      for (std::uint32_t n = list.first_of_row[y]; n < list.first_of_row[y + 1]; ++n) {
        EXPECT_EQ(list.samples[n].pixel / static_cast<std::uint32_t>(size.width), y);
      }
    }
  }
};

/// Inputs of one call.
struct Drawing {
  ParallelView view;
  Grid grid{{16, 16, 16}, {1, 1, 1}, {0, 0, 0}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
  RasterOptions options{};
  unsigned threads = 1;

  /// Calls draw(scene, pool) for surfaces, which need no clusters yet.
  template <typename Draw>
  [[nodiscard]] Result<void> with_scene(std::span<const SurfaceDraw> meshes, const Draw& draw) const {
    std::vector<SurfaceDraw> surfaces(meshes.begin(), meshes.end());
    std::list<SurfaceClusters> clusters;
    for (SurfaceDraw& surface : surfaces) surface.clusters = &clusters.emplace_back(*surface.mesh, grid);
    ThreadPool pool(threads);
    const Lighting lighting(view);
    Result<std::uint64_t> drawn =
        draw(raster_scene(surfaces, view, factorise(view, grid), grid, lighting), pool);
    if (!drawn) return tl::unexpected<Error>(drawn.error());
    for (const SurfaceDraw& surface : surfaces) *drawn -= surface.mesh->triangles.size();
    EXPECT_EQ(*drawn, 0u);
    return {};
  }

  [[nodiscard]] Result<Drawn> draw(std::span<const SurfaceDraw> meshes) const {
    FragmentList list;
    return with_scene(meshes, [&](const RasterScene& scene,
                                  ThreadPool& pool) { return Rasterizer().draw(scene, options, list, pool); })
        .map([&] { return Drawn(list, view.size); });
  }

  [[nodiscard]] Picture paint(std::span<const SurfaceDraw> meshes) const {
    Picture picture;
    EXPECT_TRUE(with_scene(meshes, [&](const RasterScene& scene, ThreadPool& pool) {
      return Rasterizer().paint(scene, options, picture, nullptr, pool);
    }));
    return picture;
  }
};

SurfaceDraw translucent(const SurfaceMesh& mesh, StructureIndex structure = 0, float opacity = 0.5f) {
  return {&mesh, nullptr, structure, {1, 1, 1}, opacity};
}

/// Triangles in the plane y = 0 (the picture plane at azimuth 0), with normals towards the viewer.
SurfaceMesh flat_mesh(std::vector<std::array<float, 2>> corners_xz,
                      std::vector<std::array<std::uint32_t, 3>> triangles) {
  SurfaceMesh mesh;
  for (const auto& corner : corners_xz) {
    mesh.positions_ijk.push_back({corner[0], 0, corner[1]});
    mesh.normals_lps.push_back({0, -1, 0});
  }
  mesh.triangles = std::move(triangles);
  return mesh;
}

std::map<std::uint32_t, int> fragments_per_pixel(const Drawn& list) {
  std::map<std::uint32_t, int> counts;
  for (const PixelFragment& fragment : list.fragments) ++counts[fragment.pixel];
  return counts;
}

/// Opaque surfaces keep one fragment per pixel; these are translucent and keep all.
TEST(Rasterize, CoversEachCentreOfAClosedSurfaceAnEvenNumberOfTimes) {
  std::mt19937 random(1);
  const auto real = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  std::size_t covered = 0;
  for (int trial = 0; trial < 60; ++trial) {
    Drawing drawing{view_from(real(0, 360), real(-90, 90), {64, 64}, real(0.05, 0.6), {4, 4, 4})};
    drawing.grid.size = {9, 9, 9};
    if (trial % 3 == 0) {
      // Axis-parallel, with pixel centres exactly on vertices and edges: tests the fill rule.
      drawing.view = view_from(90 * (trial % 4), 0, {64, 64}, trial % 2 == 0 ? 0.25 : 0.5, {4, 4, 4});
    }
    const SurfaceMesh mesh = marching_tetrahedra(
        make_mask(drawing.grid.size, [&](auto...) { return real(0, 1) < 0.4; }), drawing.grid);
    const SurfaceDraw surface = translucent(mesh);
    const Drawn list = *drawing.draw({&surface, 1});
    for (const auto& [pixel, count] : fragments_per_pixel(list)) {
      ASSERT_EQ(count % 2, 0) << "trial " << trial << ", pixel " << pixel % 64 << ", " << pixel / 64;
    }
    covered += list.fragments.size();
  }
  EXPECT_GT(covered, 100000u);
}

TEST(Rasterize, GivesCentresOnEdgesToTheTriangleBelowOrRightOfThem) {
  // 8 by 6 pixels of 1 mm, centres at whole mm: corners, the shared edge and all outer edges cross centres.
  const Drawing drawing{view_from(0, 0, {8, 6}, 1, {0.5, 0, 0.5})};
  const SurfaceMesh mesh = flat_mesh({{-2, -1}, {2, -1}, {2, 2}, {-2, 2}}, {{0, 1, 2}, {0, 2, 3}});
  const SurfaceDraw surface = translucent(mesh);
  const Drawn list = *drawing.draw({&surface, 1});
  std::vector<std::uint32_t> pixels;
  for (const PixelFragment& fragment : list.fragments) pixels.push_back(fragment.pixel);
  // Pixel (x, y) has its centre at (x - 3, z = 3 - y): x from -2 to 1 and z from 2 down to 0.
  std::vector<std::uint32_t> expected;
  for (std::uint32_t y = 1; y <= 3; ++y) {
    for (std::uint32_t x = 1; x <= 4; ++x) expected.push_back(8 * y + x);
  }
  EXPECT_EQ(pixels, expected);
}

TEST(Rasterize, TakesDepthFromThePlane) {
  const Drawing drawing{view_from(30, 20, {40, 30}, 0.25, {8, 8, 8})};
  SurfaceMesh mesh;
  mesh.positions_ijk = {{2, 3, 4}, {13, 6, 5}, {6, 11, 13}};
  mesh.normals_lps.assign(3, {0, -1, 0});
  mesh.triangles = {{0, 1, 2}};
  const SurfaceDraw surface = translucent(mesh);
  const Drawn list = *drawing.draw({&surface, 1});
  ASSERT_GT(list.fragments.size(), 200u);
  // n . p = n . p0 with n = (p1 - p0) x (p2 - p0) = (11, 3, 1) x (4, 8, 9).
  const Vec3 n{19, -95, 76};
  const Shear shear = factorise(drawing.view, drawing.grid);
  for (const PixelFragment& fragment : list.fragments) {
    const Vec3 p = drawing.view.point_lps_mm(fragment.pixel % 40 + 0.5, fragment.pixel / 40 + 0.5);
    const Vec3& d = drawing.view.forward_lps;
    const double s = (n[0] * (2 - p[0]) + n[1] * (3 - p[1]) + n[2] * (4 - p[2])) /
                     (n[0] * d[0] + n[1] * d[1] + n[2] * d[2]);
    const std::size_t axis = shear.scan.slice_axis;
    const double depth = (p[axis] + s * d[axis]) * (shear.ascending ? 1 : -1);
    EXPECT_NEAR(fragment.depth, depth, 2e-6);  // float of about 10; not rounded to 1/4096
  }
}

TEST(Rasterize, LeavesNothingOfTrianglesWithoutAnArea) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  SurfaceMesh mesh = flat_mesh({{-2, -1}, {2, -1}, {2, 2}}, {{0, 1, 2}});
  const Drawing drawing{view_from(0, 0, {16, 12}, 0.4, {0, 0, 0})};
  const SurfaceDraw surface = translucent(mesh);
  const std::size_t good = drawing.draw({&surface, 1})->fragments.size();
  EXPECT_GT(good, 20u);

  const std::vector<std::array<float, 3>> bad{
      {nan, 0, 0}, {0, nan, 0}, {0, 0, infinity}, {-infinity, 0, 0}, {0, -infinity, nan}};
  for (const auto& position : bad) {
    mesh.positions_ijk.push_back(position);
    mesh.normals_lps.push_back({nan, nan, nan});
    mesh.triangles.push_back({0, 1, static_cast<std::uint32_t>(mesh.positions_ijk.size() - 1)});
  }
  mesh.triangles.push_back({0, 0, 1});  // repeated vertices
  mesh.triangles.push_back({1, 1, 1});
  mesh.positions_ijk.push_back({0, 0, -1});  // on the edge from 0 to 1
  mesh.normals_lps.push_back({0, 0, 0});
  mesh.triangles.push_back({0, 1, static_cast<std::uint32_t>(mesh.positions_ijk.size() - 1)});
  EXPECT_EQ(drawing.draw({&surface, 1})->fragments.size(), good);
}

TEST(Rasterize, LightsSurfacesWithoutAUsableNormalAsIfTheyFacedTheViewer) {
  SurfaceMesh mesh = flat_mesh({{-2, -1}, {2, -1}, {2, 2}}, {{0, 1, 2}});
  const Drawing drawing{view_from(0, 0, {16, 12}, 0.4, {0, 0, 0})};
  const SurfaceDraw surface = translucent(mesh, 0, 1.0f);
  for (const float value : {0.0f, std::numeric_limits<float>::quiet_NaN()}) {
    mesh.normals_lps.assign(3, {value, value, value});
    const Drawn list = *drawing.draw({&surface, 1});
    ASSERT_FALSE(list.fragments.empty());
    const float expected = Lighting(drawing.view).on_surface({0, -1, 0}).diffuse;
    for (const PixelFragment& fragment : list.fragments) EXPECT_NEAR(fragment.rgba[0], expected, 1e-6f);
  }
}

/// At a silhouette, normals may point past the edge: such pixels stay dark from either side.
TEST(Rasterize, LightsTheSideOfATriangleThatIsSeenWhereverItsNormalsPoint) {
  SurfaceMesh mesh = flat_mesh({{-4, -4}, {4, -4}, {0, 4}}, {{0, 1, 2}});
  mesh.normals_lps[0] = mesh.normals_lps[1] = {0.4f, 0.3f, -0.8f};  // away from viewer and light
  for (const auto& [azimuth, side] : {std::pair{0.0, 1.0f}, std::pair{180.0, -1.0f}}) {
    const Drawing drawing{view_from(azimuth, 0, {40, 40}, 0.25, {0, 0, 0})};
    const SurfaceDraw surface{&mesh, nullptr, 0, {0.8f, 0.8f, 0.8f}, 1};
    std::vector<float> bottom_row;
    const Drawn list = *drawing.draw({&surface, 1});
    for (const PixelFragment& fragment : list.fragments) {
      const double z = -(static_cast<double>(fragment.pixel / 40) + 0.5 - 20) * 0.25;
      const auto top = static_cast<float>((z + 4) / 8);  // weight of the third vertex
      const Vec3 normal{side * (1 - top) * 0.4f, side * ((1 - top) * 0.3f - top), side * (1 - top) * -0.8f};
      const auto expected = reference::shade_surface(drawing.view, {0.8f, 0.8f, 0.8f}, normal);
      EXPECT_NEAR(fragment.rgba[0], expected[0], 1e-5) << "azimuth " << azimuth << ", z " << z;
      if (fragment.pixel / 40 == 35) bottom_row.push_back(fragment.rgba[0]);
    }
    ASSERT_GT(bottom_row.size(), 25u);
    if (side > 0) {
      for (const float value : bottom_row) EXPECT_NEAR(value, 0.8f * 0.15f, 1e-6f);
    }
  }
}

/// Two structures share a face of different diagonals. Each ray leaves one before it enters the other.
TEST(Rasterize, LeavesOneStructureBeforeItEntersTheNextWhereTheyTouch) {
  const auto face = [](bool other_diagonal, float normal_y) {
    SurfaceMesh mesh;
    mesh.positions_ijk = {{2.5f, 7.5f, 1.5f}, {13.5f, 7.5f, 1.5f}, {13.5f, 7.5f, 12.5f}, {2.5f, 7.5f, 12.5f}};
    mesh.normals_lps.assign(4, {0, normal_y, 0});
    mesh.triangles = other_diagonal ? std::vector<std::array<std::uint32_t, 3>>{{1, 2, 3}, {3, 0, 1}}
                                    : std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {0, 2, 3}};
    return mesh;
  };
  const SurfaceMesh near_back = face(false, 1);
  const SurfaceMesh far_front = face(true, -1);
  std::size_t pairs = 0;
  for (int view = 0; view < 40; ++view) {
    const Drawing drawing{view_from(-75 + 3.7 * view, -60 + 2.9 * view, {96, 96}, 0.2, {8, 7.5, 7})};
    // The structure behind has the smaller number and is first in the list.
    const std::array surfaces{translucent(far_front, 0), translucent(near_back, 1)};
    const Drawn list = *drawing.draw(surfaces);
    for (std::size_t n = 0; n + 1 < list.fragments.size(); n += 2) {
      ASSERT_EQ(list.fragments[n].pixel, list.fragments[n + 1].pixel);
      ASSERT_EQ(list.fragments[n].structure, 1u) << "view " << view << ", pixel " << list.fragments[n].pixel;
      ++pairs;
    }
  }
  EXPECT_GT(pairs, 20000u);
}

TEST(Rasterize, SortsByDepthAndDropsWhatAnOpaqueSurfaceHides) {
  std::vector<SurfaceMesh> planes;
  for (const float y : {9.0f, 1.0f, 5.0f, 3.0f}) {
    planes.push_back(flat_mesh({{-9, -9}, {9, -9}, {0, 9}}, {{0, 1, 2}}));
    for (auto& position : planes.back().positions_ijk) position[1] = y;
  }
  const Drawing drawing{view_from(0, 0, {8, 8}, 1, {0, 0, 0})};
  const std::array surfaces{translucent(planes[0], 0), translucent(planes[1], 1),
                            translucent(planes[2], 2, 1.0f), translucent(planes[3], 3)};
  const Drawn list = *drawing.draw(surfaces);
  ASSERT_GT(list.fragments.size(), 60u);
  ASSERT_EQ(list.fragments.size() % 3, 0u);
  for (std::size_t n = 0; n < list.fragments.size(); n += 3) {
    EXPECT_EQ(list.fragments[n].structure, 1u);
    EXPECT_EQ(list.fragments[n + 1].structure, 3u);
    EXPECT_EQ(list.fragments[n + 2].structure, 2u);
    EXPECT_EQ(list.fragments[n].pixel, list.fragments[n + 2].pixel);
  }
}

TEST(Rasterize, RefusesMoreFragmentsThanAllowed) {
  const SurfaceMesh mesh = flat_mesh({{-9, -9}, {9, -9}, {0, 9}}, {{0, 1, 2}});
  const SurfaceDraw surface = translucent(mesh);
  Drawing drawing{view_from(0, 0, {32, 32}, 0.5, {0, 0, 0})};
  const std::size_t fragments = drawing.draw({&surface, 1})->fragments.size();
  drawing.options.max_fragments = fragments;
  EXPECT_TRUE(drawing.draw({&surface, 1}).has_value());
  drawing.options.max_fragments = fragments - 1;
  const auto refused = drawing.draw({&surface, 1});
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().code, ErrorCode::kLimit);
}

/// Surfaces of `count` random masks, with one voxel of `every` inside.
std::vector<SurfaceMesh> noise_meshes(std::mt19937& random, int count, unsigned every, const Grid& grid) {
  std::vector<SurfaceMesh> meshes;
  while (count-- > 0) {
    const auto mask = make_mask(grid.size, [&](auto...) { return random() % every == 0; });
    meshes.push_back(marching_tetrahedra(mask, grid));
  }
  return meshes;
}

/// Painted pixels are the means of their samples, each composited front to back.
TEST(Rasterize, PaintsWhatItsFragmentsShow) {
  std::mt19937 random(9);
  Drawing drawing{view_from(33, 21, {150, 70}, 0.2, {8, 8, 8})};
  const std::vector<SurfaceMesh> meshes = noise_meshes(random, 2, 4, drawing.grid);
  for (const float opacity : {1.0f, 0.3f}) {
    for (const std::size_t samples : {1u, 4u}) {
      drawing.options.edge_samples = samples;
      const std::array surfaces{translucent(meshes[0], 0, 1.0f), translucent(meshes[1], 1, opacity)};
      FragmentList list;
      ASSERT_TRUE(drawing.with_scene(surfaces, [&](const RasterScene& scene, ThreadPool& pool) {
        return Rasterizer().draw(scene, drawing.options, list, pool);
      }));
      std::vector<double> sums(std::size_t{4} * 150 * 70), counts(std::size_t{150} * 70, 1e-9);
      for (std::size_t n = 0; n < list.sample_count(); ++n) {
        double transmittance = 1;
        counts[list.samples[n].pixel] += 1;
        for (const Fragment& fragment : list.of_sample(n)) {
          for (std::size_t c = 0; c < 4; ++c)
            sums[4 * std::size_t{list.samples[n].pixel} + c] +=
                transmittance * static_cast<double>(fragment.rgba[c]);
          transmittance *= 1 - static_cast<double>(fragment.rgba[3]);
        }
      }
      const Picture painted = drawing.paint(surfaces);
      for (std::size_t n = 0; n < sums.size(); ++n)
        ASSERT_NEAR(painted.rgba[n], sums[n] / counts[n / 4], 1e-5)
            << opacity << ", " << samples << ": " << n;
    }
  }
}

/// Back faces of closed surfaces are hidden anyway. Their silhouettes may differ by single pixels.
TEST(Rasterize, OmitsBackFacesOfClosedSurfacesUnseen) {
  std::mt19937 random(10);
  const Drawing drawing{view_from(33, 21, {150, 130}, 0.15, {8, 8, 8})};
  SurfaceMesh mesh = noise_meshes(random, 1, 4, drawing.grid)[0];
  const SurfaceDraw surface = translucent(mesh, 0, 1.0f);
  const Picture with = drawing.paint({&surface, 1});
  mesh.position_scale = static_cast<std::uint32_t>(SurfaceRule::kSmooth);
  const Picture without = drawing.paint({&surface, 1});
  std::size_t differences = 0;
  for (std::size_t n = 0; n < with.rgba.size(); n += 4) {
    EXPECT_EQ(with.rgba[n + 3], without.rgba[n + 3]);
    if (with.rgba[n] != without.rgba[n]) ++differences;
  }
  EXPECT_LT(differences, with.rgba.size() / 4 / 500);
}

}  // namespace
}  // namespace splatlas
