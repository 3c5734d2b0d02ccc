#include "player/render/view/shear.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/format/random_volume.h"
#include "tests/reference/ray.h"
#include "tests/support/render.h"
#include "tests/support/render_with.h"

namespace splatlas {
namespace {

double random_real(double low, double high) {
  return low + (high - low) * *uniform<int>(0, 1 << 30) / static_cast<double>(1 << 30);
}

/// An anisotropic, oblique, mirrored or sheared grid, in any axis order.
Grid random_grid() {
  Grid grid;
  for (auto& n : grid.size) n = *uniform<std::int64_t>(1, 300);
  for (double& mm : grid.spacing_mm) mm = std::exp(random_real(-3, 3));
  for (double& mm : grid.origin_lps_mm) mm = random_real(-500, 500);
  const std::size_t turn = *uniform<std::size_t>(0, 2);
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t row = 0; row < 3; ++row) grid.direction_lps[3 * row + a] = random_real(-0.3, 0.3);
    grid.direction_lps[3 * ((a + turn) % 3) + a] = *rc::gen::arbitrary<bool>() ? 1 : -1;
  }
  return grid;
}

ParallelView random_view(const Grid& grid) {
  const Camera camera{
      .azimuth_deg = *rc::gen::arbitrary<bool>() ? 45.0 * *uniform<int>(-8, 8) : random_real(-360, 360),
      .elevation_deg = *rc::gen::arbitrary<bool>() ? 45.0 * *uniform<int>(-2, 2) : random_real(-90, 90),
      .zoom = std::exp(random_real(-3, 3)),
      .center_lps_mm = index_to_lps_mm(grid).apply({random_real(0, 300), random_real(0, 300), 7})};
  return *parallel_view(camera, {*uniform<int>(1, 2000), *uniform<int>(1, 2000)}, {0, 1, {0, 0, 0}, 100});
}

RC_GTEST_PROP(Shear, PointsOnARayShareTheirPlaceInTheSheet, ()) {
  const Grid grid = random_grid();
  const ParallelView view = random_view(grid);
  const Shear shear = factorise(view, grid);
  const double x = random_real(-10, view.size.width + 10);
  const double y = random_real(-10, view.size.height + 10);
  const Affine2& map = shear.picture_to_sheet;
  const double u = map.xx * x + map.xy * y + map.x0;
  const double v = map.yx * x + map.yy * y + map.y0;
  const reference::Ray ray = reference::ray_through(view, grid, x, y);
  for (const double s_mm : {-300.0, -1.0, 0.0, 17.0, 250.0}) {
    const Vec3 at = ray.at(s_mm);
    const double k = at[shear.scan.slice_axis];
    const double scale = std::abs(at[0]) + std::abs(at[1]) + std::abs(at[2]) + std::abs(u) + std::abs(v) + 1;
    RC_ASSERT(std::abs(at[shear.scan.scan_axis] + shear.u_shift(k) - u) < 1e-11 * scale);
    RC_ASSERT(std::abs(at[shear.scan.row_axis] + shear.v_shift(k) - v) < 1e-11 * scale);
  }
}

RC_GTEST_PROP(Shear, SlopesAreAtMostOneAndSlabsAreOneSliceLong, ()) {
  const Grid grid = random_grid();
  const ParallelView view = random_view(grid);
  const Shear shear = factorise(view, grid);
  RC_ASSERT(std::abs(shear.slope_u) <= 1);
  RC_ASSERT(std::abs(shear.slope_v) <= 1);
  const reference::Ray ray = reference::ray_through(view, grid, 0, 0);
  const double slices = shear.slab_mm * ray.per_mm[shear.scan.slice_axis];
  RC_ASSERT(std::abs(slices - (shear.ascending ? 1 : -1)) < 1e-12);
  RC_ASSERT(shear.k_ref == 0.5 * static_cast<double>(grid.size[shear.scan.slice_axis] - 1));
}

TEST(Shear, StraightViewsHaveNone) {
  const Grid grid{{30, 40, 50}, {1, 2, 0.5}, {7, 8, 9}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
  const Axis kPrincipal[] = {Axis::kY, Axis::kY, Axis::kX, Axis::kX, Axis::kZ, Axis::kZ};
  const bool kAscending[] = {true, false, false,
                             true, false, true};  // LPS: the anterior view points along +y
  const double kSlabMm[] = {2, 2, 1, 1, 0.5, 0.5};
  for (std::size_t n = 0; n < 6; ++n) {
    const ParallelView view = *parallel_view(Camera::of(static_cast<NamedView>(n)), {64, 64}, Display{});
    const Shear shear = factorise(view, grid);
    EXPECT_EQ(shear.principal, kPrincipal[n]);
    EXPECT_EQ(shear.ascending, kAscending[n]);
    EXPECT_EQ(shear.slope_u, 0);
    EXPECT_EQ(shear.slope_v, 0);
    EXPECT_DOUBLE_EQ(shear.slab_mm, kSlabMm[n]);
  }
}

TEST(Shear, PrincipalAxisChangesAtFortyFiveDegreesAndNowhereElse) {
  const Grid grid{{32, 32, 32}, {1, 1, 1}, {0, 0, 0}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
  for (int step = -1800; step <= 1800; ++step) {
    const Camera camera{.azimuth_deg = step / 10.0};
    const Shear shear = factorise(*parallel_view(camera, {8, 8}, Display{}), grid);
    const double from_y = std::abs(std::remainder(camera.azimuth_deg, 180));
    if (std::abs(from_y - 45) > 1e-9) {
      EXPECT_EQ(shear.principal, from_y < 45 ? Axis::kY : Axis::kX) << camera.azimuth_deg;
    }
    EXPECT_NEAR(std::max(std::abs(shear.slope_u), std::abs(shear.slope_v)),
                std::tan(std::min(from_y, 90 - from_y) * 3.14159265358979323846 / 180), 1e-12);
  }
}

TEST(Shear, ForcedAxesAreTaken) {
  const Grid grid{{32, 32, 32}, {1, 1, 1}, {0, 0, 0}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
  const Camera camera{.azimuth_deg = 50, .elevation_deg = 25};
  const ParallelView view = *parallel_view(camera, {8, 8}, Display{});
  for (const Axis axis : kAxes) {
    const Shear shear = factorise(view, grid, &axis);
    EXPECT_EQ(shear.principal, axis);
    EXPECT_NEAR(shear.slab_mm * std::abs(view.forward_lps[static_cast<std::size_t>(axis)]), 1, 1e-12);
  }
}

/// A view parallel to the slices crosses none of them.
TEST(Shear, RenderRefusesAForcedAxisThatTheViewRunsAcross) {
  TestVolume volume;
  volume.grid = {{8, 8, 8}, {1, 1, 1}, {0, 0, 0}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
  volume.structures = {{"a", full_mask(volume.grid.size)}};
  const AtlasContent content = make_content(volume);
  Renderer renderer = renderer_of(content, selection_of("a:both", content.graph));
  for (const double azimuth : {0.0, 1e-9}) {
    const Camera camera{.azimuth_deg = azimuth};
    for (const Axis axis : {Axis::kX, Axis::kZ}) {
      const auto picture = render_with(renderer, camera, {.size = {16, 16}}, {.principal_axis = axis});
      ASSERT_FALSE(picture.has_value()) << "azimuth " << azimuth;
      EXPECT_EQ(picture.error().code, ErrorCode::kUsage);
    }
    EXPECT_TRUE(render_with(renderer, camera, {.size = {16, 16}}, {.principal_axis = Axis::kY}).has_value());
  }
}

}  // namespace
}  // namespace splatlas
