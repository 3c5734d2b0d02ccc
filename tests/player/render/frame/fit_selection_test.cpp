// Fit of cameras to selections: Renderer::fit().
#include "player/render/frame/fit_selection.h"

#include <cmath>
#include <memory>
#include <random>

#include <gtest/gtest.h>

#include "format/content/run_model.h"
#include "player/camera_moves.h"
#include "tests/support/fails_with.h"
#include "tests/support/phantom_content.h"
#include "tests/support/random_scene.h"
#include "tests/support/render.h"
#include "tests/support/repetitions.h"

namespace splatlas {
namespace {

constexpr double kMargin = 0.02;  // of the picture's sides

/// Calls use(index) for every voxel that a plan draws.
template <typename Use>
void for_each_drawn_voxel(const Atlas& atlas, const DrawPlan& plan, const Use& use) {
  const auto rows = static_cast<std::uint64_t>(atlas.grid().size[1]);
  for (const ClassDraw& draw : plan.classes) {
    if (!draws_volume(draw.role)) continue;
    for (const Run& run : value_or_throw(atlas.read_runs(draw.id, Axis::kZ))) {
      for (std::uint32_t i = run.start; i < run.start + run.length; ++i)
        use(Vec3{1.0 * i, static_cast<double>(run.scanline % rows),
                 static_cast<double>(run.scanline / rows)});
    }
  }
}

/// Corners of the drawn content by voxel: volumes with the reach of interpolation, vertices of surfaces.
std::vector<Vec3> corners_lps(const Atlas& atlas, const Selection& selection) {
  const DrawPlan plan = atlas.tree().plan(selection);
  const Affine to_lps = index_to_lps_mm(atlas.grid());
  std::vector<Vec3> corners;
  for_each_drawn_voxel(atlas, plan, [&](const Vec3& voxel) {
    for (unsigned corner = 0; corner < 8; ++corner) {
      Vec3 index = voxel;
      for (std::size_t a = 0; a < 3; ++a) index[a] += (corner >> a & 1u) != 0 ? 1 : -1;
      corners.push_back(to_lps.apply(index));
    }
  });
  for (const StructureIndex s : plan.surfaces) {
    const SurfaceMesh mesh = value_or_throw(atlas.read_surface(s));
    for (const auto& p : mesh.positions_ijk) corners.push_back(to_lps.apply({p[0], p[1], p[2]}));
  }
  return corners;
}

/// Extents of points in a picture: -1 and 1 are its borders.
struct Extents {
  double left = 2, right = -2, top = 2, bottom = -2;
};

Extents extents_in(const View& view, const std::vector<Vec3>& points) {
  Extents extents;
  for (const Vec3& point : points) {
    const auto shown = view.picture_point(point);
    EXPECT_TRUE(shown) << "behind the eye";
    if (!shown) continue;
    const double x = 2 * shown->x / view.plane.size.width - 1, y = 2 * shown->y / view.plane.size.height - 1;
    extents = {std::min(extents.left, x), std::max(extents.right, x), std::min(extents.top, y),
               std::max(extents.bottom, y)};
  }
  return extents;
}

/// Scene whose every drawn voxel and surface is visible. Every other one is in perspective.
RandomScene visible_scene(std::uint32_t number) {
  RandomScene scene = random_scene(number);
  for (StructureDraw& draw : scene.selection.structures) {
    draw.opacity = 0.9f;
    draw.volume = {};
    draw.volume.curve = std::make_shared<const TransferCurve>(TransferCurve{{{0, 0.9f, 1}}});
  }
  scene.options.size = {80 + static_cast<int>(number * 7 % 50), 80 + static_cast<int>(number * 11 % 50)};
  if (number % 2 == 1) {
    scene.camera.projection = CameraProjection::kPerspective;
    scene.camera.field_of_view_deg = std::array{5.0, 15.0, 30.0}[number / 2 % 3];
  }
  return scene;
}

/// Some region of a picture.
PictureRegion random_region(std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto share = [&](double max) { return max * std::generate_canonical<double, 32>(random); };
  return {share(0.4), share(0.4), 1 - share(0.4), 1 - share(0.4)};
}

/// The extents relative to a region: -1 and 1 are its borders.
Extents within(const PictureRegion& region, const Extents& of) {
  const auto relative = [](double at, double from, double to) { return (at + 1 - from - to) / (to - from); };
  return {relative(of.left, region.left, region.right), relative(of.right, region.left, region.right),
          relative(of.top, region.top, region.bottom), relative(of.bottom, region.top, region.bottom)};
}

/// The content touches the margins of its region on both sides of one axis, and crosses no margin. It lies in
/// the middle of both axes. All of it is in front of the eye.
TEST(FitSelection, TouchesTheMarginsAndCrossesNone) {
  std::uint32_t drawn = 0;
  for (std::uint32_t number = 0; drawn < repetitions(200); ++number) {
    SCOPED_TRACE(number);
    RandomScene scene = visible_scene(number);
    if (number % 8 == 3) scene.camera.field_of_view_deg = 60;
    if (number % 8 == 7) scene.camera.field_of_view_deg = 150;
    const auto atlas = open_in_memory(scene.content);
    const std::vector<Vec3> corners = corners_lps(*atlas, scene.selection);
    Renderer renderer = renderer_of(scene.content, scene.selection);
    const PictureRegion region = number % 3 == 0 ? PictureRegion() : random_region(number);
    const Camera camera = value_or_throw(renderer.fit(scene.camera, scene.options, std::nullopt, region));
    EXPECT_EQ(camera.azimuth_deg, scene.camera.azimuth_deg);
    EXPECT_EQ(camera.elevation_deg, scene.camera.elevation_deg);
    if (corners.empty()) {
      EXPECT_EQ(camera.zoom, 1);
      EXPECT_EQ(camera.center_lps_mm, std::nullopt);
      continue;
    }
    ++drawn;
    const View view = value_or_throw(view_of(camera, scene.options.size, atlas->display()));
    const Extents shown = within(region, extents_in(view, corners));
    // Coordinates of some hundred mm have 13 digits behind the point, and pixels are above 1e-3 mm
    constexpr double kRounding = 1e-9;
    const bool is_wide = shown.right - shown.left > shown.bottom - shown.top;
    EXPECT_LE(std::max(shown.right, shown.bottom), 1 - 2 * kMargin + kRounding);
    EXPECT_GE(std::min(shown.left, shown.top), 2 * kMargin - 1 - kRounding);
    const bool is_perspective = scene.camera.projection == CameraProjection::kPerspective;
    // With a wider field of view, the nearest corner keeps the eye away
    if (is_perspective && scene.camera.field_of_view_deg > 90) continue;
    const double to_middle = is_perspective ? 1e-6 : kRounding;
    EXPECT_NEAR(shown.right, -shown.left, to_middle);
    EXPECT_NEAR(shown.bottom, -shown.top, to_middle);
    EXPECT_NEAR(is_wide ? shown.right : shown.bottom, 1 - 2 * kMargin, kRounding);
    EXPECT_NEAR(is_wide ? shown.left : shown.top, 2 * kMargin - 1, kRounding);
  }
}

/// Points of the drawn content that the cuts keep: samples of the boxes of voxels, and of triangles.
std::vector<Vec3> kept_points_lps(const Atlas& atlas, const Selection& selection, const CutPlanes& cuts) {
  static constexpr int kSteps = 6;
  const DrawPlan plan = atlas.tree().plan(selection);
  const Affine to_lps = index_to_lps_mm(atlas.grid());
  std::vector<Vec3> points;
  const auto add = [&](const Vec3& index) {
    const Vec3 p = to_lps.apply(index);
    const auto keeps = [&](const CutPlane& cut) { return dot(cut.normal_lps, p) <= cut.offset_mm; };
    if (std::ranges::all_of(cuts, keeps)) points.push_back(p);
  };
  for_each_drawn_voxel(atlas, plan, [&](const Vec3& voxel) {
    for (int n = 0; n < kSteps * kSteps * kSteps; ++n) {
      const auto step = [](int of) { return 2.0 * of / (kSteps - 1) - 1; };
      add({voxel[0] + step(n % kSteps), voxel[1] + step(n / kSteps % kSteps),
           voxel[2] + step(n / kSteps / kSteps)});
    }
  });
  for (const StructureIndex s : plan.surfaces) {
    const SurfaceMesh mesh = value_or_throw(atlas.read_surface(s));
    for (const auto& corners : mesh.triangles) {
      for (int u = 0; u < kSteps; ++u) {
        for (int v = 0; u + v < kSteps; ++v) {
          const std::array<double, 3> weights{u / (kSteps - 1.0), v / (kSteps - 1.0),
                                              (kSteps - 1.0 - u - v) / (kSteps - 1.0)};
          Vec3 index{};
          for (std::size_t c = 0; c < 3; ++c) {
            for (std::size_t a = 0; a < 3; ++a) index[a] += weights[c] * mesh.positions_ijk[corners[c]][a];
          }
          add(index);
        }
      }
    }
  }
  return points;
}

/// Largest extent of a voxel in the picture, in pixels.
double voxel_pixels(const View& view, const Grid& grid) {
  const Affine to_lps = index_to_lps_mm(grid);
  double right = 0, up = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    Vec3 axis{};
    axis[a] = 1;
    const Vec3 mm = to_lps.apply_linear(axis);
    right += std::abs(dot(mm, view.plane.right_lps));
    up += std::abs(dot(mm, view.plane.up_lps));
  }
  return std::max(right, up) / view.plane.mm_per_pixel;
}

/// Samples and interpolation leave some voxels of room.
TEST(FitSelection, FitsToThePartThatCutsKeep) {
  std::uint32_t drawn = 0, smaller = 0;
  for (std::uint32_t number = 0; drawn < repetitions(60); ++number) {
    SCOPED_TRACE(number);
    RandomScene scene = visible_scene(number);
    scene.options.size = {200, 150};
    const auto atlas = open_in_memory(scene.content);
    std::mt19937 random(number);
    std::normal_distribution<double> normal;
    const Affine to_lps = index_to_lps_mm(atlas->grid());
    const Vec3 size{static_cast<double>(atlas->grid().size[0]), static_cast<double>(atlas->grid().size[1]),
                    static_cast<double>(atlas->grid().size[2])};
    const Vec3 middle = to_lps.apply({0.5 * size[0], 0.5 * size[1], 0.5 * size[2]});
    for (std::uint32_t n = 0; n <= number % 3; ++n) {
      const Vec3 side{normal(random), normal(random), normal(random)};
      ASSERT_TRUE(scene.options.cuts.add({side, dot(side, middle)}));
    }
    const std::vector<Vec3> points = kept_points_lps(*atlas, scene.selection, scene.options.cuts);
    if (points.empty()) continue;
    ++drawn;
    Renderer renderer = renderer_of(scene.content, scene.selection);
    const Camera camera = value_or_throw(renderer.fit(scene.camera, scene.options));
    const View view = value_or_throw(view_of(camera, scene.options.size, atlas->display()));
    const Extents shown = extents_in(view, points);
    const double side = 1 - 2 * kMargin + 1e-9;
    EXPECT_LE(std::max(shown.right, shown.bottom), side);
    EXPECT_GE(std::min(shown.left, shown.top), -side);
    // In perspective, a voxel near the eye is larger than one in the plane of the centre
    if (scene.camera.projection == CameraProjection::kPerspective) continue;
    constexpr double kRoom = 3;
    const double voxel = voxel_pixels(view, atlas->grid());
    const double room = std::min((2 - (shown.right - shown.left)) * 100 - 4 * kMargin * 100,
                                 (2 - (shown.bottom - shown.top)) * 75 - 4 * kMargin * 75);
    EXPECT_LE(room, 2 * kRoom * voxel);
    const Camera whole = value_or_throw(renderer.fit(scene.camera, {.size = scene.options.size}));
    if (whole.zoom < camera.zoom) ++smaller;
  }
  EXPECT_GT(smaller, repetitions(60) / 4);
}

TEST(FitSelection, RefusesRegionsOutsideThePicture) {
  const AtlasContent content = phantom_content();
  Renderer renderer = renderer_of(content, selection_of("*", content.graph));
  for (const PictureRegion& region :
       {PictureRegion{-0.1, 0, 1, 1}, PictureRegion{0, 0, 1, 1.1}, PictureRegion{0.5, 0, 0.5, 1},
        PictureRegion{0, 0.6, 1, 0.4}, PictureRegion{0, 0, NAN, 1}})
    EXPECT_THAT(renderer.fit({}, {}, std::nullopt, region), FailsWith(ErrorCode::kUsage, testing::_));
}

/// Pixels of a picture that show something: columns and rows from first to last.
struct Silhouette {
  int left = 1 << 20, right = -1, top = 1 << 20, bottom = -1;
};

Silhouette silhouette_of(const Picture& picture) {
  constexpr float kVisible = 1.0f / 255;
  Silhouette of;
  for (int y = 0; y < picture.size.height; ++y) {
    for (int x = 0; x < picture.size.width; ++x) {
      if (picture.at(x, y)[3] < kVisible) continue;
      of = {std::min(of.left, x), std::max(of.right, x), std::min(of.top, y), std::max(of.bottom, y)};
    }
  }
  return of;
}

TEST(FitSelection, SilhouettesEndAtTheMargins) {
  std::uint32_t drawn = 0;
  for (std::uint32_t number = 0; drawn < repetitions(200); ++number) {
    SCOPED_TRACE(number);
    RandomScene scene = visible_scene(number);
    scene.options.quality = Quality::kNormal;
    Renderer renderer = renderer_of(scene.content, scene.selection);
    const DrawPlan plan = renderer.atlas().tree().plan(scene.selection);
    if (plan.classes.empty()) continue;
    ++drawn;
    const Camera camera = value_or_throw(renderer.fit(scene.camera, scene.options));
    const Picture picture = render_or_throw(renderer, camera, scene.options);
    const Silhouette seen = silhouette_of(picture);
    const View view = value_or_throw(view_of(camera, picture.size, renderer.atlas().display()));
    const double voxel = voxel_pixels(view, renderer.atlas().grid());
    const double margin_x = kMargin * picture.size.width, margin_y = kMargin * picture.size.height;
    const double room = std::min({seen.left - margin_x, picture.size.width - margin_x - seen.right - 1,
                                  seen.top - margin_y, picture.size.height - margin_y - seen.bottom - 1});
    EXPECT_GE(room, -1) << describe(scene);
    EXPECT_LE(room, voxel) << describe(scene);
  }
}

/// The data of the picture, and no other chunk.
TEST(FitSelection, ReadsTheDataOfThePicture) {
  for (std::uint32_t number = 0; number < repetitions(100); ++number) {
    SCOPED_TRACE(number);
    RandomScene scene = visible_scene(number);
    if (number % 4 == 0) scene.options.classification = Classification::kAfter;
    Renderer fits = renderer_of(scene.content, scene.selection);
    const Camera camera = value_or_throw(fits.fit(scene.camera, scene.options));
    const Atlas::Counters of_fit = fits.atlas().counters();
    (void)render_or_throw(fits, camera, scene.options);
    Renderer plain = renderer_of(scene.content, scene.selection);
    (void)render_or_throw(plain, camera, scene.options);
    EXPECT_EQ(of_fit.read, plain.atlas().counters().read);
    EXPECT_EQ(of_fit.decoded, plain.atlas().counters().decoded);
    EXPECT_EQ(fits.atlas().counters().read, of_fit.read);
    EXPECT_EQ(fits.atlas().counters().decoded, of_fit.decoded);
  }
}

/// A fit to a structure is the fit of a selection of the structure alone.
TEST(FitSelection, FitsToAPartOfTheSelection) {
  using phantom_structure::kSphere2;
  const AtlasContent content = phantom_content();
  for (const std::string mode : {"volume", "surface", "both"}) {
    Renderer renderer = renderer_of(content, selection_of("*:" + mode, content.graph));
    Renderer alone = renderer_of(content, selection_of("Sphere_2:" + mode, content.graph));
    const Camera direction{.azimuth_deg = 33, .elevation_deg = 21};
    const std::vector<StructureIndex> part{kSphere2};
    const Camera fitted = value_or_throw(renderer.fit(direction, {}, part));
    const Camera expected = value_or_throw(alone.fit(direction));
    EXPECT_EQ(fitted.zoom, expected.zoom);
    EXPECT_EQ(fitted.center_lps_mm, expected.center_lps_mm);
    const Camera whole = value_or_throw(renderer.fit(direction));
    EXPECT_GT(fitted.zoom, whole.zoom);
    EXPECT_EQ(value_or_throw(renderer.fit(direction, {}, std::vector<StructureIndex>{})).zoom, 1);
    EXPECT_EQ(value_or_throw(alone.fit(direction, {}, std::vector<StructureIndex>{99})).zoom, 1);
  }
}

}  // namespace
}  // namespace splatlas
