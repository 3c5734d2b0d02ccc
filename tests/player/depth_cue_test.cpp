// Depth cue in frames of sheets and of rays.
#include <cmath>
#include <stop_token>

#include <gtest/gtest.h>

#include "format/tasks/task_control.h"
#include "player/render/frame/frame_renderer.h"
#include "player/render/rays/cast_rays.h"
#include "player/render_options.h"
#include "tests/player/prepared_selection.h"
#include "tests/support/render.h"
#include "tests/support/standard_scenes.h"
#include "tests/support/uniform_box.h"

namespace splatlas {
namespace {

/// A wall and a block in front of its centre, seen from anterior (along +y), 8 mm apart.
AtlasContent wall_and_block() {
  TestVolume volume;
  volume.grid.size = {40, 20, 40};
  volume.structures = {{"wall", box_mask(volume.grid.size, {0, 14, 0}, {39, 19, 39}), {255, 255, 255}},
                       {"block", box_mask(volume.grid.size, {14, 0, 14}, {25, 5, 25}), {255, 255, 255}}};
  return make_content(volume);
}

struct Mode {
  const char* name;
  const char* selection;
  CameraProjection projection;
  Classification classification;
};
constexpr Mode kModes[] = {
    {"sheets", "*:volume(opacity=1)", CameraProjection::kParallel, Classification::kBefore},
    {"surfaces", "*:surface", CameraProjection::kParallel, Classification::kBefore},
    {"both", "wall:volume(opacity=1) + block:surface", CameraProjection::kParallel, Classification::kBefore},
    {"rays", "*:volume(opacity=1)", CameraProjection::kParallel, Classification::kAfter},
    {"perspective", "wall:surface + block:volume(opacity=1)", CameraProjection::kPerspective,
     Classification::kBefore}};

RenderOptions options_of(const Mode& mode, DepthCue cue) {
  return {.size = {96, 96}, .classification = mode.classification, .hybrid_shading = false, .depth_cue = cue};
}

TEST(DepthCueOfFrames, DarkensTheWallAroundTheBlockAndNothingElse) {
  const AtlasContent content = wall_and_block();
  for (const Mode& mode : kModes) {
    Camera camera = Camera::of(NamedView::kAnterior);
    camera.projection = mode.projection;
    camera.zoom = 1.2;
    const Selection selection = selection_of(mode.selection, content.graph);
    const Picture off = render_or_throw(content, selection, camera, options_of(mode, DepthCue::kNone));
    RenderOptions options = options_of(mode, DepthCue::kEdges);
    const Picture on = render_with_threads(content, selection, camera, options);
    const double mm_per_pixel = view_of(camera, options.size, content.display)->plane.mm_per_pixel;
    // The side of the block is 6 mm from the centre; the radius of the cue is 2 pixels.
    const int edge = static_cast<int>(
        std::ceil(6.6 / mm_per_pixel * (mode.projection == CameraProjection::kPerspective ? 1.08 : 1)));
    EXPECT_EQ(on.at(48, 48), off.at(48, 48)) << mode.name;  // the block
    EXPECT_EQ(on.at(48 + edge + 9, 48), off.at(48 + edge + 9, 48))
        << mode.name;  // the wall, away from the block
    EXPECT_EQ(on.at(0, 0), off.at(0, 0)) << mode.name;
    float min = 1;
    for (int x = 48; x < 48 + edge + 9; ++x) {
      ASSERT_GT(off.at(x, 48)[0], 0.01f) << mode.name << x;
      min = std::min(min, on.at(x, 48)[0] / off.at(x, 48)[0]);
      EXPECT_EQ(on.at(x, 48)[3], off.at(x, 48)[3]);
    }
    EXPECT_LT(min, 0.75f) << mode.name;
    EXPECT_GE(min, 0.3f - 1e-6f) << mode.name;

    options.depth_cue_strength = 0;
    EXPECT_EQ(render_or_throw(content, selection, camera, options).rgba, off.rgba) << mode.name;
  }
}

/// Depth maps: the faces of the block and of the wall, infinity around them, and nothing else changes.
TEST(DepthMaps, LieOnTheNearestFaces) {
  const AtlasContent content = wall_and_block();
  for (const Mode& mode : kModes) {
    Camera camera = Camera::of(NamedView::kAnterior);
    camera.projection = mode.projection;
    Renderer renderer = renderer_of(content, selection_of(mode.selection, content.graph));
    RenderOptions options = options_of(mode, DepthCue::kNone);
    options.depths = true;
    const Frame frame = frame_or_throw(renderer, camera, options);
    ASSERT_EQ(frame.depths.size, options.size);
    const View view = *view_of(camera, options.size, content.display);
    const ViewDepth depth(view, renderer.atlas().grid());
    const auto mm_at = [&](int x, int y) { return frame.depths.mm[static_cast<std::size_t>(96 * y + x)]; };
    // Surfaces lie within 0.1 voxel of a face; a volume's field rises over the voxel around it.
    EXPECT_NEAR(mm_at(48, 48), depth.mm(48.5, 48.5, 1, -0.5), 0.5) << mode.name;
    EXPECT_NEAR(mm_at(36, 36), depth.mm(36.5, 36.5, 1, 13.5), 0.5) << mode.name;
    EXPECT_EQ(mm_at(0, 0), DepthMap::kBackground) << mode.name;

    // The picture and the depth cue remain as they are
    options.depths = false;
    const Frame plain = frame_or_throw(renderer, camera, options);
    EXPECT_EQ(plain.picture.rgba, frame.picture.rgba) << mode.name;
    EXPECT_TRUE(plain.depths.empty());
    options.depth_cue = DepthCue::kEdges;
    Frame cue = frame_or_throw(renderer, camera, options);
    EXPECT_TRUE(cue.depths.empty());
    const Picture darkened = cue.picture;
    options.depths = true;
    ASSERT_TRUE(renderer.render(camera, options, cue));
    EXPECT_EQ(cue.depths.mm, frame.depths.mm) << mode.name;
    EXPECT_EQ(cue.picture.rgba, darkened.rgba) << mode.name;
  }
}

/// The depth of transmittance 1/2 in a slab is known: in the middle of every pixel.
TEST(DepthCueOfFrames, VolumesLieAtTransmittanceOneHalf) {
  TestVolume volume;
  volume.grid = {{30, 24, 28}, {1, 1.5, 0.8}, {-15, -18, -11}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
  volume.structures = {{"box", full_mask(volume.grid.size)}};
  const AtlasContent content = make_content(volume);
  PreparedSelection prepared(content, selection_of("box(opacity=0.2)", content.graph), 2);
  const Grid& grid = prepared.atlas->grid();
  ThreadPool& pool = prepared.pool;
  const double length = std::cbrt(1.2);
  const double half_mm = std::log(0.5) / std::log(0.8) * length;
  for (const double azimuth : {0.0, 20.0, -160.0}) {
    const Camera camera{.azimuth_deg = azimuth, .zoom = 4};
    const PictureSize size{21, 19};
    const View view = *view_of(camera, size, content.display);
    const ViewDepth view_depth(view, grid);
    DepthMap of_rays;
    of_rays.clear(size);
    cast_rays(prepared.rays(Classification::kBefore), view, grid, {.depths = &of_rays}, best_march(), nullptr,
              pool);
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        const auto n = static_cast<std::size_t>(y * size.width + x);
        // Slabs begin half a voxel before the first slice; the trilinear field rises over a voxel around it.
        const double front = azimuth == -160.0 ? 23.5 : -0.5;
        const double expected = view_depth.mm(x + 0.5, y + 0.5, 1, front) + half_mm;
        EXPECT_NEAR(of_rays.mm[n], expected, 0.15) << azimuth << ": " << x << ", " << y;
      }
    }
  }
}

/// Depths are stored for the picture only: as a sheared whole, this row would cover 1e10 voxels.
TEST(DepthCueOfFrames, LongRowsSeenFromNearbyTakeLittleMemory) {
  const std::int64_t length = 100001;
  const AtlasContent content = box_content({1, 1, length});
  const Camera camera{.azimuth_deg = 45,
                      .elevation_deg = 35,
                      .zoom = zoom_for(content.display, 16, 0.25),
                      .center_lps_mm = Vec3{0, 0, 0.5 * length}};
  const RenderOptions options{.size = {16, 16}, .depth_cue = DepthCue::kEdges};
  const Picture picture =
      render_or_throw(content, with_opacity(content, 0.9f), camera, options, 1, {.principal_axis = Axis::kZ});
  EXPECT_GT(picture.at(8, 8)[3], 0.5f);
}

TEST(DepthCueOfFrames, DepthsOfSurfacesStop) {
  std::stop_source stop;
  stop.request_stop();
  const TaskControl task(stop.get_token(), {});
  const PictureSize size{4, 4};
  const View view = *view_of({}, size, Display{});
  FragmentList none;
  none.first_of_row.assign(5, 0);
  DepthMap depths;
  depths.clear(size);
  ThreadPool pool(1);
  EXPECT_THROW(add_surface_depths(none, {view, std::nullopt}, ViewDepth(view, Grid{}), depths, pool),
               Cancelled);
}

}  // namespace
}  // namespace splatlas
