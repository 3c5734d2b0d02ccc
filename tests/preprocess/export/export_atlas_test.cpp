#include "preprocess/export/export_atlas.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/phantom/two_spheres.h"
#include "tests/preprocess/build_atlas_fixture.h"
#include "tests/support/fails_with.h"
#include "tests/support/file_bytes.h"

namespace splatlas {
namespace {

class ExportSurfaces : public BuildAtlas {
 protected:
  static Image image_of(const std::vector<std::uint8_t>& voxels, const Vec3& spacing_mm = {1, 0.85, 0.9}) {
    Image image;
    image.grid = {.size = {phantom::kSize, phantom::kSize, phantom::kSize}, .spacing_mm = spacing_mm};
    image.voxels.type = VoxelType::kUInt8;
    const auto bytes = std::as_bytes(std::span(voxels));
    image.voxels.bytes.assign(bytes.begin(), bytes.end());
    return image;
  }
  /// Builds the phantom.
  std::string build_phantom(SurfaceRule rule, const std::string& name,
                            const Vec3& spacing_mm = {1, 0.85, 0.9}) const {
    BuildOptions options =
        this->options(image_of(phantom::labels(), spacing_mm), image_of(phantom::values(), spacing_mm));
    options.surfaces = rule;
    options.output = file(name);
    const Result<BuildReport> report = build_atlas(options);
    EXPECT_TRUE(report) << report.error().message;
    return file(name);
  }
  std::string export_surface(const std::string& atlas, const std::string& mesh, SurfaceChoice choice) const {
    ExportOptions options;
    options.atlas = atlas;
    options.surfaces = {{"Label 1", file(mesh)}};
    options.atlas_options.surfaces = choice;
    const auto written = export_atlas(options);
    EXPECT_TRUE(written && written->failures.empty());
    return read_bytes(file(mesh));
  }
  static SurfaceMesh surface_of(const std::string& atlas, SurfaceChoice choice) {
    return *(*Atlas::open(atlas, {.surfaces = choice}))->read_surface(0);
  }
};

TEST_F(ExportSurfaces, AreSmoothByDefaultAndEitherWayOnRequest) {
  ASSERT_EQ(BuildOptions().surfaces, SurfaceRule::kSmooth);
  const std::string smooth = build_phantom(SurfaceRule::kSmooth, "smooth.atlas"),
                    voxels = build_phantom(SurfaceRule::kVoxels, "voxels.atlas");
  const SurfaceMesh moved = surface_of(smooth, SurfaceChoice::kAsInFile),
                    midway = surface_of(voxels, SurfaceChoice::kAsInFile);
  EXPECT_EQ(moved.position_scale, 256u);
  EXPECT_EQ(midway.position_scale, 4u);
  EXPECT_EQ(moved.triangles, midway.triangles);
  EXPECT_EQ(moved.triangles.size(), 3704u);
  EXPECT_EQ(surface_of(smooth, SurfaceChoice::kSmooth), moved);
  EXPECT_EQ(surface_of(voxels, SurfaceChoice::kSmooth), moved);
  EXPECT_EQ(surface_of(smooth, SurfaceChoice::kVoxels), midway);
  EXPECT_EQ(surface_of(voxels, SurfaceChoice::kVoxels), midway);
  float largest = 0;
  for (std::size_t v = 0; v < moved.positions_ijk.size(); ++v) {
    for (std::size_t a = 0; a < 3; ++a)
      largest = std::max(largest, std::abs(moved.positions_ijk[v][a] - midway.positions_ijk[v][a]));
  }
  EXPECT_GT(largest, 0.25f);
  EXPECT_LT(largest, 0.5f);
}

TEST_F(ExportSurfaces, HaveTheGeometryThatPlayersDraw) {
  const std::string smooth = build_phantom(SurfaceRule::kSmooth, "smooth.atlas"),
                    voxels = build_phantom(SurfaceRule::kVoxels, "voxels.atlas");
  const Affine to_mm = index_to_lps_mm((*Atlas::open(smooth))->grid());
  for (const std::string ending : {".stl", ".ply", ".obj", ".vtk"}) {
    SCOPED_TRACE(ending);
    const std::string bytes = export_surface(smooth, "smooth" + ending, SurfaceChoice::kAsInFile);
    const SurfaceMesh drawn = surface_of(smooth, SurfaceChoice::kAsInFile);
    const auto back = value_or_throw(read_mesh(file("smooth" + ending)));
    ASSERT_EQ(back.mesh.triangles.size(), drawn.triangles.size());
    for (std::size_t t = 0; t < drawn.triangles.size(); ++t) {
      for (std::size_t n = 0; n < 3; ++n) {
        const auto& [i, j, k] = drawn.positions_ijk[drawn.triangles[t][n]];
        const Vec3 expected = to_mm.apply({i, j, k});
        for (std::size_t a = 0; a < 3; ++a) {
          // Six digits of text, of at most 64 mm
          EXPECT_NEAR(back.mesh.positions_lps_mm[back.mesh.triangles[t][n]][a], expected[a], 1e-4);
        }
      }
    }
    const std::string plain = export_surface(smooth, "voxels" + ending, SurfaceChoice::kVoxels);
    EXPECT_EQ(plain, export_surface(voxels, "same" + ending, SurfaceChoice::kAsInFile));
    EXPECT_EQ(bytes, export_surface(voxels, "again" + ending, SurfaceChoice::kSmooth));
  }
}

/// Readers derive the surfaces of thick slices, and their coarse levels.
TEST_F(ExportSurfaces, OfThickSlicesAreDerived) {
  const std::string thick = build_phantom(SurfaceRule::kSmooth, "thick.atlas", {1, 1, 3});
  const auto atlas = Atlas::open(thick).value();
  EXPECT_TRUE(atlas->verify());
  const SurfaceMesh smooth = surface_of(thick, SurfaceChoice::kAsInFile);
  EXPECT_EQ(smooth.position_scale, static_cast<std::uint32_t>(SurfaceRule::kUneven));
  EXPECT_EQ(smooth.triangles.size(), 3704u);
  const std::string voxels = build_phantom(SurfaceRule::kVoxels, "voxels.atlas", {1, 1, 3});
  EXPECT_EQ(surface_of(voxels, SurfaceChoice::kSmooth), smooth);
  EXPECT_EQ(surface_of(thick, SurfaceChoice::kVoxels), surface_of(voxels, SurfaceChoice::kAsInFile));
  ASSERT_TRUE(atlas->has_levels(0));
  EXPECT_LT(atlas->read_surface(0, 1)->triangles.size(), smooth.triangles.size() / 3);
  EXPECT_FALSE(export_surface(thick, "thick.ply", SurfaceChoice::kAsInFile).empty());
  const auto back = value_or_throw(read_mesh(file("thick.ply")));
  EXPECT_EQ(back.mesh.triangles.size(), smooth.triangles.size());
}

}  // namespace
}  // namespace splatlas
