// Cuts: clipped volumes and surfaces, and their faces.
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "player/renderer.h"
#include "tests/support/fails_with.h"
#include "tests/support/phantom_content.h"
#include "tests/support/render.h"
#include "tests/support/test_content.h"

namespace splatlas {
namespace {

CutPlanes cuts_of(const std::vector<CutPlane>& planes) {
  CutPlanes cuts;
  for (const CutPlane& plane : planes) EXPECT_TRUE(cuts.add(plane));
  return cuts;
}

/// A box of 21^3 voxels of 1 mm around the origin, left half "l", right half "r" with other grey values.
AtlasContent halves() {
  TestVolume volume;
  volume.grid.size = {21, 21, 21};
  volume.grid.origin_lps_mm = {-10, -10, -10};
  std::vector<std::uint8_t> greys;
  for (int n = 0; n < 21 * 21 * 21; ++n) greys.push_back(n % 21 < 10 ? 50 : 150);
  volume.values = make_values(VoxelType::kUInt8, greys);
  volume.window_high = 200;
  volume.structures.push_back({"r", box_mask(volume.grid.size, {2, 2, 2}, {9, 18, 18})});
  volume.structures.push_back({"l", box_mask(volume.grid.size, {10, 2, 2}, {18, 18, 18})});
  return make_content(volume);
}

std::array<float, 4> middle_pixel(const Picture& picture, int right = 0, int down = 0) {
  const auto pixel = static_cast<std::size_t>((picture.size.height / 2 + down) * picture.size.width +
                                              picture.size.width / 2 + right);
  std::array<float, 4> rgba{};
  std::copy_n(&picture.rgba[4 * pixel], 4, rgba.begin());
  return rgba;
}

TEST(CutPlanes, RefusesBadPlanes) {
  CutPlanes cuts;
  for (const CutPlane& bad : {CutPlane{{0, 0, 0}, 1},
                              {{std::nan(""), 0, 1}, 0},
                              {{HUGE_VAL, 0, 0}, 0},
                              {{0, 1, 0}, std::nan("")},
                              {{0, 1, 0}, HUGE_VAL}}) {
    EXPECT_THAT(cuts.add(bad), FailsWith(ErrorCode::kUsage, testing::HasSubstr("finite numbers")));
  }
  for (int n = 0; n < 6; ++n) EXPECT_TRUE(cuts.add({{1, 0, 0}, 1.0 * n}));
  EXPECT_THAT(cuts.add({{1, 0, 0}, 7}),
              FailsWith(ErrorCode::kUsage, testing::HasSubstr("more than 6 planes")));
  EXPECT_EQ(cuts.size(), 6u);
}

/// Planes beside everything change no bit; planes before everything leave nothing.
TEST(Cuts, KeepAllOrNothing) {
  const AtlasContent content = phantom_content();
  for (const char* text : {"Spheres", "Spheres:surface", "Sphere_1:both(opacity=0.5) + Sphere_2"}) {
    Renderer renderer = renderer_of(content, selection_of(text, content.graph));
    for (const auto projection : {CameraProjection::kParallel, CameraProjection::kPerspective}) {
      for (const Quality quality : {Quality::kDraft, Quality::kNormal, Quality::kHigh}) {
        const Camera camera{.azimuth_deg = 20, .elevation_deg = 10, .projection = projection};
        RenderOptions options{.size = {60, 50}, .quality = quality};
        const Picture whole = render_or_throw(renderer, camera, options);
        options.cuts = cuts_of({{{1, 0.1, 0}, 1e4}, {{0, -1, 0.3}, 1e4}});
        const Frame kept = frame_or_throw(renderer, camera, options);
        EXPECT_EQ(kept.picture.rgba, whole.rgba) << text;
        EXPECT_GT(kept.stats.voxels_visited + kept.stats.triangles, 0u);
        options.cuts = cuts_of({{{1, 0.1, 0}, -1e4}});
        const Picture empty = render_or_throw(renderer, camera, options);
        EXPECT_EQ(empty.rgba, std::vector<float>(empty.rgba.size())) << text;
      }
    }
  }
}

/// Opacity through the middle of a homogeneous block that planes cut at any angle, against the closed form.
TEST(Cuts, ClipHomogeneousBlocksExactly) {
  AtlasContent content = halves();
  content.values = {};
  const Selection selection = selection_of("*:volume(opacity=0.1)", content.graph);
  Renderer renderer = renderer_of(content, selection);
  for (const auto classification : {Classification::kBefore, Classification::kAfter}) {
    for (const Quality quality : {Quality::kDraft, Quality::kNormal, Quality::kHigh}) {
      RenderOptions options{.size = {41, 41},
                            .quality = quality,
                            .classification = classification,
                            .hybrid_shading = false,
                            .termination_threshold = 0};
      options.caps = CapMode::kNone;
      for (const double front_mm : {-3.3, 0.0, 2.61}) {
        // The view from anterior enters at y = front_mm and leaves at y = 5.2
        options.cuts = cuts_of({{{0.2, -1, 0.1}, -front_mm}, {{0, 2, 0}, 2 * 5.2}});
        const Picture picture = render_or_throw(renderer, Camera::of(NamedView::kAnterior), options);
        const double expected = 1 - std::pow(0.9, 5.2 - front_mm);
        EXPECT_NEAR(middle_pixel(picture)[3], expected, 1e-5) << front_mm;
        if (quality != Quality::kDraft) continue;
        options.draft_budget_ms = 1e-9;  // the next draft is of blocks of voxels, linear between sheet pixels
        options.cuts = cuts_of({{{0, -1, 0}, -front_mm}, {{0, 2, 0}, 2 * 5.2}});
        static_cast<void>(render_or_throw(renderer, Camera::of(NamedView::kAnterior), options));
        const Frame late = frame_or_throw(renderer, Camera::of(NamedView::kAnterior), options);
        EXPECT_EQ(late.stats.level > 0, classification == Classification::kBefore);
        EXPECT_NEAR(middle_pixel(late.picture)[3], expected, 1e-5) << front_mm;
        options.draft_budget_ms = 0;
      }
    }
  }
}

/// No ray of a coarse pixel goes beyond its own cut, to a fragment at the pixel's centre.
TEST(Cuts, EndEachRayOfAPixelThatHasFragments) {
  const AtlasContent content = halves();
  const RenderOptions options{.size = {9, 9}, .quality = Quality::kHigh, .cuts = cuts_of({{{0.1, 3, 0}, 1}})};
  const auto picture = [&](const char* text) {
    return render_or_throw(content, selection_of(text, content.graph), {.azimuth_deg = -90}, options).rgba;
  };
  const auto with_clear_surface = picture("r(opacity=0.2) + l:surface(opacity=1e-6)");
  EXPECT_THAT(with_clear_surface, testing::Pointwise(testing::FloatNear(1e-4f), picture("r(opacity=0.2)")));
}

/// Faces show the structures that a plane cuts, with their opacity.
TEST(Cuts, HaveFacesOfStructures) {
  const AtlasContent content = halves();
  const auto face_at = [&](const char* text, CapMode caps, double anterior_mm, int right) {
    Renderer renderer = renderer_of(content, selection_of(text, content.graph));
    RenderOptions options{.size = {63, 63}, .hybrid_shading = false};
    options.cuts = cuts_of({{{0, -1, 0}, -anterior_mm}});
    options.caps = caps;
    return middle_pixel(render_or_throw(renderer, Camera::of(NamedView::kAnterior), options), right);
  };
  const auto linear = [](double encoded) { return std::pow((encoded + 0.055) / 1.055, 2.4); };
  constexpr const char* kSolid = "l:surface(color=#ff0000) + r:surface(color=#00ff00)";
  using Rgba = std::array<float, 4>;

  // The picture's right is the subject's left
  EXPECT_EQ(face_at(kSolid, CapMode::kLabels, 0.2, 9), (Rgba{1, 0, 0, 1}));
  EXPECT_EQ(face_at(kSolid, CapMode::kLabels, 0.2, -9), (Rgba{0, 1, 0, 1}));
  const auto values = face_at(kSolid, CapMode::kValues, 0.2, 9);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(values[c], linear(150.0 / 200), 1e-5);
  const auto both = face_at(kSolid, CapMode::kBoth, 0.2, -9);
  EXPECT_NEAR(both[1], linear(50.0 / 200) / 0.7152, 1e-5);  // darker than green
  EXPECT_EQ(both[0], 0);
  EXPECT_EQ(both[3], 1);
  const auto bright = face_at(kSolid, CapMode::kBoth, 0.2, 9);
  EXPECT_NEAR(bright[0], 1, 1e-5);
  EXPECT_NEAR(bright[1], (linear(150.0 / 200) - 0.2126) / (1 - 0.2126), 1e-5);  // brighter than red

  // Without faces, the far wall of the surface shows
  EXPECT_NE(face_at(kSolid, CapMode::kNone, 0.2, 9), (Rgba{1, 0, 0, 1}));
  // A face in front of fog, and no face beside the selection
  const auto translucent = face_at("l:surface(opacity=0.25,color=#ff0000)", CapMode::kLabels, 9.5, 9);
  EXPECT_EQ(translucent, (Rgba{0, 0, 0, 0})) << "the plane is behind the structure";
  EXPECT_EQ(face_at("l:surface", CapMode::kLabels, 0.2, -9), (Rgba{0, 0, 0, 0}));
  // Voxels that the transfer function hides have no face
  EXPECT_EQ(face_at("r:volume(low=60,high=100)", CapMode::kLabels, 0.2, -9), (Rgba{0, 0, 0, 0}));
  // The latest term wins
  EXPECT_EQ(face_at("*:volume(color=#0000ff) + l:surface(color=#ff0000)", CapMode::kLabels, 0.2, 9),
            (Rgba{1, 0, 0, 1}));
}

/// The plane between two layers of voxels shows the layer that stays.
TEST(Cuts, ShowTheKeptSideBetweenVoxels) {
  const AtlasContent content = halves();
  Renderer renderer = renderer_of(
      content, selection_of("l:surface(color=#ff0000) + r:surface(color=#00ff00)", content.graph));
  RenderOptions options{.size = {40, 40}};
  options.caps = CapMode::kLabels;
  options.cuts = cuts_of({{{1, 0, 0}, -0.5}});
  EXPECT_EQ(middle_pixel(render_or_throw(renderer, Camera::of(NamedView::kLeft), options))[1], 1);
  options.cuts = cuts_of({{{-1, 0, 0}, 0.5}});
  EXPECT_EQ(middle_pixel(render_or_throw(renderer, Camera::of(NamedView::kRight), options))[0], 1);
}

/// The surface of "m" is all of an octahedron without voxels. Those of "v" beside the plane have weight 0.
TEST(Cuts, HaveNoFaceWhereNoVoxelShowsAStructure) {
  TestVolume volume;
  volume.grid.size = {9, 9, 9};
  volume.structures.push_back({"v", box_mask(volume.grid.size, {0, 0, 5}, {8, 8, 8})});
  volume.structures.push_back({"m", box_mask(volume.grid.size, {0, 0, 0}, {0, 0, 0})});
  AtlasContent content = make_content(volume);
  SurfaceMesh& mesh = content.surfaces[1];
  mesh = {};
  for (std::size_t n = 0; n < 6; ++n) {
    std::array<float, 3> outwards{};
    outwards[n / 2] = n % 2 == 0 ? -1.0f : 1.0f;
    mesh.normals_lps.push_back(outwards);
    for (float& index : outwards) index = 4 + 3 * index;
    mesh.positions_ijk.push_back(outwards);
  }
  mesh.triangles = {{0, 4, 2}, {4, 1, 2}, {1, 5, 2}, {5, 0, 2}, {4, 0, 3}, {1, 4, 3}, {5, 1, 3}, {0, 5, 3}};
  Renderer renderer = renderer_of(content, selection_of("*:surface", content.graph));
  RenderOptions options{.size = {40, 40}, .cuts = cuts_of({{{0, 0, 1}, 4}})};
  const auto picture = [&](CapMode caps) {
    options.caps = caps;
    return render_or_throw(renderer, Camera::of(NamedView::kSuperior), options);
  };
  EXPECT_EQ(middle_pixel(picture(CapMode::kValues))[3], 1);
  EXPECT_EQ(picture(CapMode::kValues).rgba, picture(CapMode::kNone).rgba);
}

/// They meet far beyond the range of pixel numbers.
TEST(Cuts, ShowTheRearOneOfNearlyParallelPlanes) {
  const AtlasContent content = halves();
  Renderer renderer = renderer_of(content, selection_of("l + r", content.graph));
  const Camera camera{.azimuth_deg = 90, .zoom = 3};
  RenderOptions options{.size = {40, 30}, .caps = CapMode::kLabels};
  const CutPlane rear{{1, 0, 0}, -5};
  options.cuts = cuts_of({rear});
  const Frame expected = frame_or_throw(renderer, camera, options);
  for (const double tilt : {1e-17, -1e-17}) {
    const CutPlane front{{1, tilt, 0}, 5};
    for (const std::vector<CutPlane>& planes : {std::vector{rear, front}, {front, rear}}) {
      options.cuts = cuts_of(planes);
      const Frame frame = frame_or_throw(renderer, camera, options);
      EXPECT_EQ(frame.picture.rgba, expected.picture.rgba);
    }
  }
}

/// Drafts of opaque surfaces are painted, and have the picture of those that need fragments: for ids.
TEST(Cuts, OfPaintedSurfacesHaveThePictureOfFragments) {
  const AtlasContent content = phantom_content();
  for (const char* text : {"Spheres:surface", "Sphere_1:surface + Sphere_2:surface(opacity=0.4)"}) {
    Renderer renderer = renderer_of(content, selection_of(text, content.graph));
    for (const auto projection : {CameraProjection::kParallel, CameraProjection::kPerspective}) {
      const Camera camera{.azimuth_deg = 50, .elevation_deg = 25, .projection = projection};
      RenderOptions options{.size = {90, 80}, .quality = Quality::kDraft};
      options.cuts = cuts_of({{{0.3, -1, 0.2}, 1}, {{0.8, 0.8, 0}, 20}});
      const Frame painted = frame_or_throw(renderer, camera, options);
      options.ids = true;
      const Frame fragments = frame_or_throw(renderer, camera, options);
      int faces = 0;
      for (std::size_t n = 0; n < painted.picture.rgba.size(); ++n) {
        EXPECT_NEAR(painted.picture.rgba[n], fragments.picture.rgba[n], 1e-6) << text;
        faces += painted.picture.rgba[n] != 0 ? 1 : 0;
      }
      EXPECT_GT(faces, 1000);
      for (const double x : {30.5, 45.5, 60.5}) {
        const auto pick = painted.pick(x, 40.5), expected = fragments.pick(x, 40.5);
        ASSERT_EQ(pick.has_value(), expected.has_value()) << x;
        EXPECT_EQ(pick.value_or(Pick{}).structure, expected.value_or(Pick{}).structure) << x;
      }
    }
  }
}

/// Drafts within a budget end rays at opaque faces and surfaces, and put faces around the volume.
TEST(Cuts, KeepTheirPictureInDraftsWithinABudget) {
  const AtlasContent content = halves();
  for (const char* text : {"*:volume(opacity=0.3)", "l:volume(profile=hard) + r:volume(opacity=0.2)",
                           "l:surface + r:volume(opacity=0.3)"}) {
    Renderer renderer = renderer_of(content, selection_of(text, content.graph));
    for (const auto projection : {CameraProjection::kParallel, CameraProjection::kPerspective}) {
      const Camera camera{.azimuth_deg = 50, .elevation_deg = 25, .projection = projection};
      RenderOptions options{.size = {160, 150}, .quality = Quality::kDraft};
      options.cuts = cuts_of({{{0.3, -1, 0.2}, 1}, {{0.8, 0.8, 0}, 6}});
      const std::vector<float> exact = render_or_throw(renderer, camera, options).rgba;
      options.draft_budget_ms = 1e6;
      const std::vector<float> rough = render_or_throw(renderer, camera, options).rgba;
      int shown = 0, differ = 0;
      for (std::size_t n = 0; n < exact.size(); ++n) {
        shown += exact[n] > 0 ? 1 : 0;
        differ += std::abs(rough[n] - exact[n]) > 0.01f ? 1 : 0;
      }
      EXPECT_GT(shown, 10000);
      EXPECT_LT(differ, shown / 40) << text;  // silhouettes in the volume
    }
  }
}

/// Removed spans cost nothing.
TEST(Cuts, VisitOnlyKeptVoxels) {
  const AtlasContent content = phantom_content();
  Renderer renderer = renderer_of(content, selection_of("Spheres", content.graph));
  RenderOptions options{.size = {64, 64}};
  for (const NamedView view : {NamedView::kAnterior, NamedView::kLeft, NamedView::kSuperior}) {
    const auto visited = [&](const CutPlanes& cuts) {
      options.cuts = cuts;
      return static_cast<double>(frame_or_throw(renderer, Camera::of(view), options).stats.voxels_visited);
    };
    EXPECT_LE(visited(cuts_of({{{0, 0, 1}, content.display.center_lps_mm[2]}})), 0.75 * visited({}))
        << "voxels beyond the plane contribute to the field before it";
    EXPECT_EQ(visited(cuts_of({{{0, 0, 1}, -1e4}})), 0);
  }
}

/// pick() finds faces, and nothing in the removed part.
TEST(Cuts, AreSeenByPick) {
  const AtlasContent content = halves();
  const StructureIndex l = 1;
  ASSERT_EQ(content.graph[l].id, "l");
  for (const char* text : {"l:surface", "l:volume(opacity=0.9)"}) {
    Renderer renderer = renderer_of(content, selection_of(text, content.graph));
    for (const auto projection : {CameraProjection::kParallel, CameraProjection::kPerspective}) {
      Camera camera = Camera::of(NamedView::kLeft);
      camera.projection = projection;
      RenderOptions options{.size = {64, 64}};
      options.cuts = cuts_of({{{1, 0, 0}, 3.3}});
      const auto face = frame_or_throw(renderer, camera, options).pick(32, 32);
      ASSERT_TRUE(face);
      EXPECT_EQ(face->structure, l);
      EXPECT_NEAR(face->point_lps_mm[0], 3.3, 0.6);
      options.cuts = cuts_of({{{1, 0, 0}, -0.6}});
      EXPECT_FALSE(frame_or_throw(renderer, camera, options).pick(32, 32));
    }
  }
}

/// Depth darkening leaves flat faces unchanged.
TEST(Cuts, HaveDepthsOfFacesAndOfClippedVolumes) {
  const AtlasContent content = halves();
  for (const char* text : {"*:surface(color=#ffffff)", "*:volume(opacity=0.95)"}) {
    Renderer renderer = renderer_of(content, selection_of(text, content.graph));
    for (const auto classification : {Classification::kBefore, Classification::kAfter}) {
      RenderOptions options{.size = {96, 96}, .classification = classification, .hybrid_shading = false};
      options.cuts = cuts_of({{{0.4, -1, 0.3}, 0}});
      const Picture plain = render_or_throw(renderer, {}, options);
      options.depth_cue = DepthCue::kEdges;
      const Picture cued = render_or_throw(renderer, {}, options);
      for (const int at : {-12, -5, 0, 5, 12}) {
        for (std::size_t c = 0; c < 4; ++c)
          EXPECT_NEAR(middle_pixel(cued, at, at)[c], middle_pixel(plain, at, at)[c], 0.01) << text;
      }
    }
  }
}

}  // namespace
}  // namespace splatlas
