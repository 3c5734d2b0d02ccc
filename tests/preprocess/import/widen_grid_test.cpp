// Grids that are widened for surfaces, and grids around surfaces alone.
#include <cmath>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "preprocess/import/membership_volume.h"
#include "preprocess/sources/import_sources.h"
#include "tests/preprocess/import/side_volumes.h"
#include "tests/preprocess/messages_of_notes.h"
#include "tests/support/axis_orders.h"
#include "tests/support/fails_with.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

/// A cuboid whose corners are mapped by `place`, as an OBJ file.
template <typename Place>
std::string cuboid(const Vec3& low, const Vec3& high, const Place& place) {
  std::string text = "# SPACE=LPS\n";
  for (std::size_t corner = 0; corner < 8; ++corner) {
    Vec3 at;
    for (std::size_t a = 0; a < 3; ++a) at[a] = (corner >> a & 1) != 0 ? high[a] : low[a];
    const Vec3 mm = place(at);
    text += fmt::format("v {:.17g} {:.17g} {:.17g}\n", mm[0], mm[1], mm[2]);
  }
  return text + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
}

/// Area of a clipped surface in mm^2.
double area_of(const SurfaceMesh& surface, const Grid& grid) {
  double area = 0;
  for (const auto& triangle : surface.triangles) {
    std::array<Vec3, 3> corners;
    for (std::size_t n = 0; n < 3; ++n) {
      const auto& [i, j, k] = surface.positions_ijk[triangle[n]];
      corners[n] = index_to_lps_mm(grid).apply({i, j, k});
    }
    const Vec3 twice = cross(difference(corners[1], corners[0]), difference(corners[2], corners[0]));
    area += std::sqrt(dot(twice, twice)) / 2;
  }
  return area;
}

class WidenGrid : public testing::Test {
 protected:
  SourceModel import(const SourceFiles& files) {
    notes_ = {};
    Result<SourceModel> model = import_sources(files, notes_);
    if (!model) throw std::runtime_error(model.error().message);
    return *std::move(model);
  }
  TemporaryFolder folder_;
  Notes notes_;
};

/// The instrument sticks out at the left (by 3.7 voxels beyond the last face) and below (by 1.1).
TEST_F(WidenGrid, HoldsTheInstrumentAndKeepsTheLabels) {
  for (const AxisOrder& order : all_axis_orders()) {
    for (const bool is_oblique : {false, true}) {
      Body body;
      if (is_oblique) body.axes_lps = oblique_axes();
      PlacedVolume grey = placed(body, order);
      write_bytes(folder_.file("labels.nrrd"), nrrd_in(grey, "LPS"));
      for (std::uint8_t& value : grey.values) value = static_cast<std::uint8_t>(7 + value);
      write_bytes(folder_.file("grey.nrrd"), nrrd_in(grey, "LPS"));
      const auto place = [&](const Vec3& index) {
        Vec3 mm = body.origin_lps_mm;
        for (std::size_t a = 0; a < 3; ++a) {
          for (std::size_t row = 0; row < 3; ++row)
            mm[row] += body.axes_lps[a][row] * body.spacing_mm[a] * index[a];
        }
        return mm;
      };
      write_bytes(folder_.file("needle.obj"), cuboid({4.2, 2.2, -1.6}, {11.2, 3.3, 1.2}, place));
      SourceFiles files;
      files.labels = folder_.file("labels.nrrd");
      files.volume = folder_.file("grey.nrrd");
      files.meshes = {{.name = "Needle", .file = folder_.file("needle.obj")}};
      const SourceModel cut = import(files);
      EXPECT_THAT(messages_of(notes_), ElementsAre(HasSubstr("partly outside the volume")));
      EXPECT_GT(cut.meshes[0].outside, 0.5);

      files.fit_grid = true;
      const SourceModel model = import(files);
      EXPECT_THAT(messages_of(notes_),
                  ElementsAre("1 grid is widened for surfaces: from 8x6x5 to 13x6x8 voxels"));
      EXPECT_EQ(model.meshes[0].outside, 0);
      const Grid grid = reordered(model.source_grid, storage_order(model.source_grid));
      ASSERT_EQ(grid.size, (Index3{13, 6, 8}));
      const Vec3 sides{7 * 0.75, 1.1 * 1.5, 2.8 * 3.25};
      const double area = 2 * (sides[0] * sides[1] + sides[1] * sides[2] + sides[2] * sides[0]);
      // Positions are multiples of 1/1024 voxel.
      EXPECT_NEAR(area_of(model.meshes[0].surface, grid), area, 2e-3 * area);
      const Affine to_mm = index_to_lps_mm(grid);
      for (std::int64_t v = 0; v < grid.voxels(); ++v) {
        const Index3 index{v % 13, v / 13 % 6, v / 78};
        const Index3 inner{index[0], index[1], index[2] - 3};
        const bool is_inside = inner[0] < 8 && inner[2] >= 0;
        const int mark = is_inside ? body.mark(inner) : 0;
        const auto& set = model.memberships.sets()[model.memberships.voxels()[static_cast<std::size_t>(v)]];
        ASSERT_EQ(set.empty() ? 0 : static_cast<int>(set.front()) + 1, mark);
        ASSERT_EQ(model.values.as<std::uint8_t>()[v], 7 + mark);
        const Vec3 expected = body.position(inner),
                   found = to_mm.apply({static_cast<double>(index[0]), static_cast<double>(index[1]),
                                        static_cast<double>(index[2])});
        for (std::size_t a = 0; a < 3; ++a) ASSERT_NEAR(found[a], expected[a], 1e-9);
      }
    }
  }
}

TEST_F(WidenGrid, ALittleSurfaceWithinTheGridWidensNothing) {
  const Body body;
  write_bytes(folder_.file("labels.nrrd"), nrrd_in(placed(body, {}), "LPS"));
  // Nearly to the outer faces of the outer voxels.
  const auto place = [&](const Vec3& index) {
    Vec3 mm;
    for (std::size_t a = 0; a < 3; ++a) mm[a] = body.origin_lps_mm[a] + body.spacing_mm[a] * index[a];
    return mm;
  };
  write_bytes(folder_.file("a.obj"), cuboid({-0.499, -0.499, -0.499}, {7.499, 5.499, 4.499}, place));
  SourceFiles files;
  files.labels = folder_.file("labels.nrrd");
  files.meshes = {{.name = "Box", .file = folder_.file("a.obj")}};
  files.fit_grid = true;
  const SourceModel model = import(files);
  EXPECT_EQ(model.source_grid.size, (Index3{8, 6, 5}));
  write_bytes(folder_.file("a.obj"), cuboid({0, 0, 0}, {800, 5, 4}, place));
  Notes notes;
  EXPECT_THAT(
      import_sources(files, notes),
      FailsWith(ErrorCode::kLimit, HasSubstr("--fit-grid: the surfaces would widen the grid from 8x6x5")));
  files.fit_grid = false;
  write_bytes(folder_.file("far.obj"),
              cuboid({900, -20, 30}, {901.5, 0, 31}, [](const Vec3& mm) { return mm; }));
  files.meshes.front().file = folder_.file("far.obj");
  EXPECT_THAT(
      import_sources(files, notes).error().message,
      testing::MatchesRegex(".*far.obj: lies from .900, -20, 30. to .901.5, 0, 31. mm in LPS, outside "
                            "the volume, whose labels lie from .* to .*; check its frame .*"));
}

/// 256 voxels along the longest side, which is 64 mm, and one more at each end.
TEST_F(WidenGrid, SurfacesAloneHaveAGridOfTheirOwn) {
  const auto place = [](const Vec3& mm) { return mm; };
  write_bytes(folder_.file("a.obj"), cuboid({10, -20, 30}, {74, -19, 31}, place));
  write_bytes(folder_.file("b.obj"), cuboid({20, -22, 30}, {24, -20.5, 32}, place));
  SourceFiles files;
  files.meshes = {{.name = "Plate", .file = folder_.file("a.obj")},
                  {.name = "Screw", .file = folder_.file("b.obj")}};
  const SourceModel model = import(files);
  EXPECT_THAT(messages_of(notes_), IsEmpty());
  EXPECT_EQ(model.source_grid.spacing_mm, (Vec3{0.25, 0.25, 0.25}));
  EXPECT_EQ(model.source_grid.origin_lps_mm, (Vec3{9.75, -22.25, 29.75}));
  EXPECT_EQ(model.source_grid.size, (Index3{259, 15, 11}));
  ASSERT_EQ(model.meshes.size(), 2u);
  EXPECT_NEAR(area_of(model.meshes[0].surface, model.source_grid), 2 * (64 + 64 + 1), 1e-9);
  EXPECT_NEAR(area_of(model.meshes[1].surface, model.source_grid), 2 * (4 * 1.5 + 1.5 * 2 + 2 * 4), 1e-9);
  for (std::size_t n = 0; n < 2; ++n) {
    EXPECT_EQ(model.meshes[n].outside, 0);
    EXPECT_TRUE(model.structures[n].external);
  }
  for (const double scale : {0.001, 100.0}) {
    for (MeshSource& mesh : files.meshes) mesh.scale = scale;
    import(files);
    EXPECT_THAT(messages_of(notes_), ElementsAre(HasSubstr("is its unit mm?: the longest side of all is")));
  }
}

TEST_F(WidenGrid, SurfacesOfAFolderAreNamedByTheTable) {
  std::filesystem::create_directories(folder_.file("a,b"));
  for (const std::string name : {"lung.l.obj", ".hidden.obj", "notes.txt", "Spine.obj"})
    write_bytes(folder_.file("a,b/" + name), cuboid({0, 0, 0}, {9, 9, 9}, [](const Vec3& mm) { return mm; }));
  write_bytes(folder_.file("names.csv"), "name,color\nspine,#cc6666\nlung.l,#cc3333\nspleen,#000000\n");
  SourceFiles files;
  files.names = folder_.file("names.csv");
  const auto structures = [&](const std::string& options) {
    files.meshes = {*parse_mesh(folder_.file("a,b") + options)};
    std::vector<std::string> found;
    for (const SourceStructure& structure : import(files).structures)
      found.push_back(structure.name + to_hex(*structure.color) + (structure.external ? " external" : ""));
    return found;
  };
  EXPECT_THAT(structures(""), ElementsAre("spine#cc6666 external", "lung.l#cc3333 external"));
  EXPECT_THAT(structures(",scale=2,color=#010203"),
              ElementsAre("spine#010203 external", "lung.l#010203 external"));
  EXPECT_THAT(list_files(files), testing::Contains(folder_.file("a,b/Spine.obj")));
  EXPECT_EQ(parse_mesh("A,b=c,d.stl,scale=2")->name, "A,b");
}

TEST_F(WidenGrid, UnlikelySizesNameAScale) {
  write_bytes(folder_.file("labels.nrrd"), nrrd_in(placed(Body(), {}), "LPS"));
  write_bytes(folder_.file("a.obj"), cuboid({0, 0, 0}, {30, 20, 10}, [](const Vec3& mm) { return mm; }));
  SourceFiles files;
  files.labels = folder_.file("labels.nrrd");
  for (const auto& [scale, unit] : {std::pair(1e-3, "m"), std::pair(1e3, "um")}) {
    files.meshes = {{.name = "Box", .file = folder_.file("a.obj"), .scale = scale}};
    Notes notes;
    static_cast<void>(import_sources(files, notes));
    EXPECT_THAT(messages_of(notes),
                testing::Contains(HasSubstr(fmt::format("scale=1 if its unit is {})", unit))));
  }
}

}  // namespace
}  // namespace splatlas
