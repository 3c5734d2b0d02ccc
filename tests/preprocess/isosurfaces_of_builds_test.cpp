// Isosurfaces in whole builds.
#include <cmath>
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/preprocess/build_atlas_fixture.h"
#include "tests/preprocess/random_images.h"
#include "tests/support/closed_mesh.h"
#include "tests/support/fails_with.h"
#include "tests/support/repetitions.h"

namespace splatlas {
namespace {

/// Single-precision values `value(i, j, k)`.
template <typename Value>
Image float_image(const Grid& grid, const Value& value) {
  Image image = zeros(grid, VoxelType::kFloat32);
  for (std::int64_t v = 0; v < grid.voxels(); ++v) {
    image.voxels.as<float>()[v] = static_cast<float>(
        value(v % grid.size[0], v / grid.size[0] % grid.size[1], v / grid.size[0] / grid.size[1]));
  }
  return image;
}

StructureIndex structure_of(const AtlasContent& content, const std::string& name) {
  for (StructureIndex s = 0; s < content.graph.size(); ++s) {
    if (content.graph[s].name == name) return s;
  }
  ADD_FAILURE() << name;
  return 0;
}

/// 1 for the voxels of the structure.
std::vector<std::uint8_t> held_by(const AtlasContent& content, const std::string& name) {
  const StructureIndex structure = structure_of(content, name);
  std::vector<std::uint8_t> mask;
  for (const ClassId c : content.class_volume) {
    mask.push_back(std::ranges::any_of(content.classes.members(c), [&](const Membership& member) {
      return member.structure == structure && member.holds();
    }));
  }
  return mask;
}

double enclosed_voxels(const SurfaceMesh& mesh) {
  return enclosed_volume(mesh.triangles, [&](std::uint32_t vertex) {
    const auto& [i, j, k] = mesh.positions_ijk[vertex];
    return Vec3{i, j, k};
  });
}

class IsosurfacesOfBuilds : public BuildAtlas {
 protected:
  BuildOptions scene(const Image& volume, const std::vector<std::string>& segments) const {
    BuildOptions build = options();
    build.sources.volume = write("volume.nrrd", volume);
    for (const std::string& rule : segments) build.sources.segments.push_back(*parse_segment(rule));
    return build;
  }
};

TEST_F(IsosurfacesOfBuilds, BallOfDistancesIsRound) {
  const Vec3 center{35.3, 36.1, 34.8};
  constexpr double kRadius = 30.4;
  const auto from_center = [&](double i, double j, double k) {
    return std::hypot(i - center[0], j - center[1], k - center[2]);
  };
  const Grid grid{.size = {72, 71, 70}};
  const AtlasContent content =
      build(scene(float_image(grid,
                              [&](auto i, auto j, auto k) {
                                return 100 - from_center(static_cast<double>(i), static_cast<double>(j),
                                                         static_cast<double>(k));
                              }),
                  {"Ball=iso:69.6"}));
  ASSERT_EQ(content.surfaces.size(), 1u);
  const SurfaceMesh& mesh = content.surfaces[0];
  EXPECT_TRUE(is_closed(mesh.triangles));
  constexpr double kPi = 3.14159265358979323846;
  // The deficit of the inscribed polyhedron falls with the square of the radius.
  EXPECT_NEAR(enclosed_voxels(mesh) / (4.0 / 3 * kPi * kRadius * kRadius * kRadius), 1, 1e-3);
  for (std::size_t v = 0; v < mesh.positions_ijk.size(); ++v) {
    const auto& [i, j, k] = mesh.positions_ijk[v];
    const double distance = from_center(i, j, k);
    ASSERT_NEAR(distance, kRadius, 0.02);
    const auto& normal = mesh.normals_lps[v];
    const double cosine =
        (normal[0] * (i - center[0]) + normal[1] * (j - center[1]) + normal[2] * (k - center[2])) / distance;
    ASSERT_GT(cosine, std::cos(0.03));  // packing: 0.011 rad
  }
}

TEST_F(IsosurfacesOfBuilds, VerticesInterpolateValuesLinearly) {
  std::mt19937 random(3);
  for (std::uint32_t repetition = 0; repetition < repetitions(8); ++repetition) {
    // Many values are the level itself.
    const Grid grid{.size = {9, 8, 7}};
    const Image volume = byte_image(grid, [&](auto, auto, auto) { return random() % 6; });
    const AtlasContent content = build(scene(volume, {"A=iso:3"}));
    const SurfaceMesh& mesh = content.surfaces[0];
    EXPECT_EQ(mesh.position_scale, 1024u);
    EXPECT_TRUE(is_closed(mesh.triangles));
    EXPECT_GT(enclosed_voxels(mesh), 0);
    const auto value = [&](const Index3& at) -> std::optional<double> {
      for (std::size_t a = 0; a < 3; ++a) {
        if (at[a] < 0 || at[a] >= grid.size[a]) return std::nullopt;
      }
      return volume.voxels.as<std::uint8_t>()[grid.offset(at[0], at[1], at[2])];
    };
    for (const auto& position : mesh.positions_ijk) {
      Index3 low{};
      std::size_t axis = 3;
      for (std::size_t a = 0; a < 3; ++a) {
        low[a] = static_cast<std::int64_t>(std::floor(position[a]));
        if (static_cast<float>(low[a]) != position[a]) axis = a;
      }
      ASSERT_LT(axis, 3u);
      Index3 high = low;
      ++high[axis];
      const double t = static_cast<double>(position[axis]) - static_cast<double>(low[axis]);
      const auto from = value(low), to = value(high);
      if (!from || !to) {
        ASSERT_TRUE(*(from ? from : to) >= 3);  // the border of the grid
        continue;
      }
      ASSERT_NE(*from >= 3, *to >= 3);
      const double expected = std::clamp((3 - *from) / (*to - *from), 1.0 / 1024, 1023.0 / 1024);
      ASSERT_NEAR(t, expected, 0.51 / 1024);  // rounding
    }
  }
}

TEST_F(IsosurfacesOfBuilds, StayInsideTheirStructure) {
  const Grid grid{
      .size = {14, 12, 10}, .spacing_mm = {1, 1, 2}, .direction_lps = {-1, 0, 0, 0, 1, 0, 0, 0, 1}};
  const auto grey = [](auto i, auto j, auto) { return 10 * i + j; };
  BuildOptions build = scene(byte_image(grid, grey), {"Low=threshold:0:40", "Part=iso:55:within=label 1",
                                                      "All=iso:20", "Rest=threshold:41"});
  build.sources.labels =
      write("labels.nrrd", byte_image(grid, [](auto i, auto j, auto) { return i > 2 && j < 8; }));
  const AtlasContent content = this->build(build);
  const std::vector<std::uint8_t> label = held_by(content, "Label 1"), part = held_by(content, "Part"),
                                  all = held_by(content, "All"), rest = held_by(content, "Rest");
  std::size_t parts = 0;
  for (std::size_t v = 0; v < label.size(); ++v) {
    // The storage grid mirrors i.
    const auto i = grid.size[0] - 1 - static_cast<std::int64_t>(v) % grid.size[0];
    const auto j = static_cast<std::int64_t>(v) / grid.size[0] % grid.size[1];
    ASSERT_EQ(label[v] != 0, i > 2 && j < 8);
    ASSERT_EQ(part[v] != 0, label[v] != 0 && grey(i, j, 0) >= 55);
    ASSERT_EQ(all[v] != 0, grey(i, j, 0) >= 20);
    parts += part[v];
    // Isosurfaces do not keep voxels from other segments.
    ASSERT_TRUE(rest[v] == 0 || (label[v] == 0 && all[v] != 0));
  }
  EXPECT_GT(parts, 0u);
  EXPECT_GT(std::ranges::count(rest, 1), 0);
  const SurfaceMesh& mesh = content.surfaces[structure_of(content, "Part")];
  EXPECT_TRUE(is_closed(mesh.triangles));
  EXPECT_NEAR(enclosed_voxels(mesh), static_cast<double>(parts), 0.15 * static_cast<double>(parts));
}

TEST_F(IsosurfacesOfBuilds, ValuesThatAreNotFiniteAreOutside) {
  const Grid grid{.size = {8, 8, 8}};
  const AtlasContent content = build(scene(float_image(grid,
                                                       [](auto i, auto j, auto k) {
                                                         if (i == 3 && j == 3 && k == 3)
                                                           return std::numeric_limits<double>::quiet_NaN();
                                                         if (i == 5)
                                                           return std::numeric_limits<double>::infinity();
                                                         return i > 1 && j > 1 && k > 1 ? 7.0 : 0.0;
                                                       }),
                                           {"A=iso:1"}));
  const std::vector<std::uint8_t> mask = held_by(content, "A");
  EXPECT_EQ(std::ranges::count(mask, 1), 5 * 6 * 6 - 1);
  EXPECT_TRUE(is_closed(content.surfaces[0].triangles));
}

TEST_F(IsosurfacesOfBuilds, FragmentsAreDroppedWithTheirSurface) {
  const Grid grid{.size = {12, 8, 8}};
  BuildOptions build = scene(byte_image(grid,
                                        [](auto i, auto j, auto k) {
                                          return (i > 0 && i < 6 && j > 0 && j < 6 && k > 0 && k < 6) ||
                                                 (i == 9 && j == 3 && k == 3);
                                        }),
                             {"A=iso:0.5"});
  build.fragments = {*parse_fragments("2")};
  const AtlasContent content = this->build(build);
  EXPECT_EQ(std::ranges::count(held_by(content, "A"), 1), 125);
  for (const auto& position : content.surfaces[0].positions_ijk) EXPECT_LT(position[0], 6.5f);
}

TEST_F(IsosurfacesOfBuilds, ReportWhatIsWrong) {
  const Grid grid{.size = {4, 4, 4}};
  const Image volume = byte_image(grid, [](auto i, auto, auto) { return i; });
  EXPECT_THAT(error_of(scene(volume, {"A=iso:4"})),
              HasSubstr("\"A\": no voxel of the volume has a value of 4"));
  EXPECT_THAT(build_atlas(scene(volume, {"A=iso:1", "B=iso:2:within=C"})),
              FailsWith(ErrorCode::kNotFound, HasSubstr("\"B\": within=")));
  EXPECT_THAT(error_of(scene(volume, {"A=iso:1:within=B", "B=iso:2"})), HasSubstr("earlier segment"));
  EXPECT_THAT(build_atlas(scene(volume, {"A=iso:1:within=A"})), FailsWith(ErrorCode::kUsage, testing::_));
  BuildOptions build = scene(volume, {"A=iso:2"});
  build.sources.volume.clear();
  EXPECT_THAT(error_of(build), HasSubstr("an isosurface needs a --volume"));
}

}  // namespace
}  // namespace splatlas
