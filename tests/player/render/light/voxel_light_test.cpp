#include "player/render/light/voxel_light.h"

#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "tests/player/prepared_selection.h"
#include "tests/reference/voxel_light.h"
#include "tests/support/random_scene.h"
#include "tests/support/test_content.h"

namespace splatlas {
namespace {

/// The light of all selected voxels, in memory order.
std::vector<reference::LitVoxel> light_of(PreparedSelection& prepared) {
  const Grid& grid = prepared.atlas->grid();
  std::vector<reference::LitVoxel> voxels(static_cast<std::size_t>(grid.voxels()));
  static_cast<void>(prepared.runs(Axis::kY));
  const SelectedRuns runs = prepared.runs(Axis::kZ);
  for (const std::int64_t slice : runs.occupied()) {
    runs.for_each(slice, [&](const ClassRun& run, std::uint32_t draw) {
      const auto first = static_cast<std::size_t>(grid.offset(run.start, run.row, slice));
      for (std::size_t n = first; n < first + run.length; ++n) {
        const VoxelLight* const light = prepared.cache.light(n, prepared.plan.classes[draw].boundary);
        if (light != nullptr) voxels[n] = {light->lit / 65535.0, light->normal};
      }
    });
  }
  return voxels;
}

double degrees_between(PackedNormal packed, const Vec3& direction) {
  const std::array<float, 3> n = unpack_normal(packed);
  const double cosine = dot(Vec3{n[0], n[1], n[2]}, direction) / std::sqrt(dot(direction, direction));
  return std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / std::numbers::pi;
}

template <typename Grey>
VoxelBuffer float_values(const Index3& size, const Grey& grey) {
  std::vector<float> values;
  for_each_voxel(size, [&](const Index3& at) { values.push_back(static_cast<float>(grey(at))); });
  return make_values(VoxelType::kFloat32, values);
}

/// Also after others, in which it was a border's or an interior's, by other curves.
TEST(VoxelLight, IsThatOfTheReferenceForEverySelection) {
  std::uint64_t lit = 0;
  for (std::uint32_t number = 0; number < 60; ++number) {
    const RandomScene scene = random_scene(number, 20);
    PreparedSelection prepared(scene.content, scene.selection);
    const Selection all = selection_of("*:volume(low=20,high=90)", scene.content.graph);
    for (const Selection& selection : {scene.selection, all, scene.selection}) {
      prepared.select(selection);
      const std::vector<reference::LitVoxel> expected = reference::lit_voxels(scene.content, selection);
      const std::vector<reference::LitVoxel> ours = light_of(prepared);
      for (std::size_t n = 0; n < ours.size(); ++n) {
        ASSERT_NEAR(ours[n].lit, expected[n].lit, 2e-3) << "scene " << number << ", voxel " << n;
        if (ours[n].lit < 2e-3) continue;
        ++lit;
        const std::array<float, 3> normal = unpack_normal(expected[n].normal);
        ASSERT_LT(degrees_between(ours[n].normal, {normal[0], normal[1], normal[2]}),
                  1.5)  // steps of packing
            << "scene " << number << ", voxel " << n;
      }
    }
  }
  EXPECT_GT(lit, 20000u);
}

/// At borders too, where the voxels outside are unknown, and for any spacing.
TEST(VoxelLight, FollowsARampOfGreyValues) {
  TestVolume volume;
  volume.grid.size = {14, 12, 10};
  volume.grid.spacing_mm = {0.5, 0.8, 2};
  const Vec3 per_mm{3, -2, 1};
  volume.values = float_values(volume.grid.size, [&](const Index3& at) {
    return 100 + per_mm[0] * 0.5 * static_cast<double>(at[0]) + per_mm[1] * 0.8 * static_cast<double>(at[1]) +
           per_mm[2] * 2 * static_cast<double>(at[2]);
  });
  volume.structures = {{"ball", ball_mask(volume.grid.size, {7, 6, 5}, 25)}};
  const AtlasContent content = make_content(volume);
  PreparedSelection prepared(content, selection_of("ball:volume(low=80,high=140)", content.graph));
  const std::vector<bool> inside = ball_mask(volume.grid.size, {7, 6, 5}, 9);
  const std::vector<reference::LitVoxel> light = light_of(prepared);
  for (std::size_t n = 0; n < light.size(); ++n) {
    if (!inside[n]) continue;
    EXPECT_GT(light[n].lit, 0.3);
    EXPECT_LT(degrees_between(light[n].normal, {-3, 2, -1}), 0.95);  // the error of packing
  }
}

/// Bone in a larger structure: the curve alone makes its surface.
TEST(VoxelLight, LightsAGradedBallByItsRadius) {
  TestVolume volume;
  volume.grid.size = {47, 47, 47};
  const auto from_center = [](const Index3& at) {
    return Vec3{static_cast<double>(at[0]) - 23, static_cast<double>(at[1]) - 23,
                static_cast<double>(at[2]) - 23};
  };
  volume.values = float_values(volume.grid.size, [&](const Index3& at) {
    const Vec3 r = from_center(at);
    return 1000 - 40 * std::sqrt(dot(r, r));
  });
  volume.structures = {{"all", full_mask(volume.grid.size)}};
  const AtlasContent content = make_content(volume);
  PreparedSelection prepared(content, selection_of("all:volume(curve=160:0/240:0.8)", content.graph));
  const std::vector<reference::LitVoxel> light = light_of(prepared);
  const Grid& grid = prepared.atlas->grid();
  double squares = 0, count = 0;
  for_each_voxel(grid.size, [&](const Index3& at) {
    const Vec3 r = from_center(at);
    const double radius = std::sqrt(dot(r, r));
    const reference::LitVoxel& voxel = light[static_cast<std::size_t>(grid.offset(at[0], at[1], at[2]))];
    if (radius > 18 && radius < 21.5) {
      EXPECT_EQ(voxel.lit, 1) << radius;
      squares += std::pow(degrees_between(voxel.normal, r), 2);
      ++count;
    } else if (radius < 16 && radius > 2) {
      EXPECT_EQ(voxel.lit, 0) << "constant opacity, " << radius;
    }
  });
  EXPECT_LT(std::sqrt(squares / count), 0.6);
}

TEST(VoxelLight, LeavesNoiseUnlitAndBordersToTheirLabels) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> noise(0, 255);
  TestVolume volume;
  volume.grid.size = {24, 24, 24};
  volume.values = float_values(volume.grid.size, [&](const Index3&) { return noise(random); });
  volume.structures = {{"box", box_mask(volume.grid.size, {4, 4, 4}, {19, 19, 19})}};
  const AtlasContent content = make_content(volume);
  PreparedSelection prepared(content, selection_of("box:volume(low=0,high=255)", content.graph));
  const Grid& grid = prepared.atlas->grid();
  const std::vector<reference::LitVoxel> light = light_of(prepared);
  double lit = 0, inside = 0, faces = 0;
  for_each_voxel(grid.size, [&](const Index3& at) {
    const reference::LitVoxel& voxel = light[static_cast<std::size_t>(grid.offset(at[0], at[1], at[2]))];
    const auto is_within = [&](std::int64_t margin) {
      return std::ranges::all_of(at, [&](std::int64_t x) { return x >= 4 + margin && x <= 19 - margin; });
    };
    if (is_within(1)) {
      lit += voxel.lit;
      ++inside;
    } else if (at[0] == 4 && at[1] > 7 && at[1] < 16 && at[2] > 7 && at[2] < 16) {
      EXPECT_LT(degrees_between(voxel.normal, {-1, 0, 0}), 45);
      faces += degrees_between(voxel.normal, {-1, 0, 0}) < 1 ? 1 : 0;
    }
  });
  EXPECT_LT(lit / inside, 0.02);
  EXPECT_GT(faces, 48);  // of 64
}

}  // namespace
}  // namespace splatlas
