// Surfaces in RAS beside labels in LPS, transforms and scales.
#include <bit>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "preprocess/import/meshes/import_mesh.h"
#include "tests/preprocess/messages_of_notes.h"
#include "tests/preprocess/raw_image_files.h"
#include "tests/support/closed_mesh.h"
#include "tests/support/fails_with.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

constexpr std::array<Vec3, 4> kCorners{Vec3{40, 20, 5}, Vec3{44, 20, 5}, Vec3{40, 28, 5}, Vec3{40, 20, 21}};
constexpr const char* kPoints = "40 20 5 44 20 5 40 28 5 40 20 21";
/// Counter-clockwise from outside.
constexpr std::array<std::array<int, 3>, 4> kFaces{{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};

std::string faces(const std::string& before, int first = 0) {
  std::string text;
  for (const auto& [a, b, c] : kFaces) {
    text += before + std::to_string(a + first) + " " + std::to_string(b + first) + " " +
            std::to_string(c + first) + "\n";
  }
  return text;
}

std::string vtk(const std::string& title) {
  return "# vtk DataFile Version 3.0\n" + title + "\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n" + kPoints +
         "\nPOLYGONS 4 16\n" + faces("3 ");
}

/// `space` as codes of characters, as VTK writes strings.
std::string vtp(const std::string& space) {
  return R"(<VTKFile type="PolyData" version="0.1" byte_order="LittleEndian"><PolyData>)" +
         (space.empty()
              ? ""
              : R"(<FieldData><Array type="String" Name="SPACE" NumberOfTuples="1" format="ascii">)" + space +
                    "</Array></FieldData>") +
         R"(<Piece NumberOfPoints="4" NumberOfVerts="0" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="4">)" +
         R"(<Points><DataArray type="Float32" NumberOfComponents="3" format="ascii">)" + kPoints +
         R"(</DataArray></Points><Polys><DataArray type="Int32" Name="connectivity" format="ascii">)" +
         faces("") +
         R"(</DataArray><DataArray type="Int32" Name="offsets" format="ascii">3 6 9 12</DataArray>)" +
         "</Polys></Piece></PolyData></VTKFile>\n";
}

std::string stl(const std::string& header) {
  std::string bytes = header;
  bytes.resize(80, ' ');
  const std::uint32_t count = 4;
  bytes.append(reinterpret_cast<const char*>(&count), 4);
  for (const auto& face : kFaces) {
    bytes.append(12, '\0');
    for (const int corner : face) {
      for (const double mm : kCorners.at(static_cast<std::size_t>(corner))) {
        const auto number = static_cast<float>(mm);
        bytes.append(reinterpret_cast<const char*>(&number), 4);
      }
    }
    bytes.append(2, '\0');
  }
  return bytes;
}

std::string ply(const std::string& comment) {
  return "ply\nformat ascii 1.0\n" + comment +
         "element vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 4\n"
         "property list uchar int vertex_indices\nend_header\n40 20 5\n44 20 5\n40 28 5\n40 20 21\n" +
         faces("3 ");
}

std::string obj(const std::string& comment) {
  return comment + "v 40 20 5\nv 44 20 5\nv 40 28 5\nv 40 20 21\n" + faces("f ", 1);
}

/// Six times the volume within a closed surface; negative if it is inside out.
double volume_of(const TriangleMesh& mesh) {
  return 6 * enclosed_volume(mesh.triangles, [&](std::uint32_t v) { return mesh.positions_lps_mm[v]; });
}

Vec3 sum_of_corners(const TriangleMesh& mesh) {
  Vec3 sum{0, 0, 0};
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) {
      for (std::size_t a = 0; a < 3; ++a) sum[a] += mesh.positions_lps_mm[corner][a];
    }
  }
  return sum;  // each corner is in three triangles
}

class MeshFrames : public testing::Test {
 protected:
  TriangleMesh place(const std::string& name, const std::string& bytes, const std::string& options = "",
                     const std::optional<MmBox>& labelled = std::nullopt) {
    write_bytes(folder_.file(name), bytes);
    notes_ = {};
    const Result<MeshSource> source = parse_mesh("Screw=" + folder_.file(name) + options);
    if (!source) throw std::runtime_error(source.error().message);
    Result<TriangleMesh> mesh = place_mesh(*source, labelled, notes_);
    if (!mesh) throw std::runtime_error(mesh.error().message);
    return *std::move(mesh);
  }

  /// Expects kCorners with x and y times `sign`, and the outside outside.
  static void expect_corners(const TriangleMesh& mesh, double sign) {
    ASSERT_EQ(mesh.triangles.size(), 4u);
    EXPECT_EQ(sum_of_corners(mesh), (Vec3{sign * 3 * 164, sign * 3 * 88, 3 * 36}));
    EXPECT_EQ(volume_of(mesh), 4 * 8 * 16);
  }
  TemporaryFolder folder_;
  Notes notes_;
};

TEST_F(MeshFrames, FilesNameTheirFrame) {
  for (const auto& [space, codes, sign] : std::vector<std::tuple<std::string, std::string, double>>{
           {"RAS", "82 65 83 0", -1}, {"LPS", "76 80 83 0", 1}}) {
    for (const auto& [name, bytes] :
         std::vector<std::pair<std::string, std::string>>{{"a.vtk", vtk("3D Slicer output. SPACE=" + space)},
                                                          {"a.vtp", vtp(codes)},
                                                          {"a.stl", stl("3D Slicer output. SPACE=" + space)},
                                                          {"a.ply", ply("comment SPACE=" + space + "\n")},
                                                          {"a.obj", obj("# SPACE=" + space + "\n")}}) {
      SCOPED_TRACE(name + " " + space);
      expect_corners(place(name, bytes), sign);
      EXPECT_THAT(messages_of(notes_), IsEmpty());
      expect_corners(place(name, bytes, ",frame=lps"), 1);  // the user decides
      expect_corners(place(name, bytes, ",frame=ras"), -1);
    }
  }
}

TEST_F(MeshFrames, WithoutAFrameTheLabelsDecide) {
  const MmBox right{{-50, -40, 0}, {-30, -10, 30}}, left{{30, 10, 0}, {50, 40, 30}};
  for (const auto& [name, bytes] : std::vector<std::pair<std::string, std::string>>{{"a.vtk", vtk("x")},
                                                                                    {"a.vtp", vtp("")},
                                                                                    {"a.stl", stl("x")},
                                                                                    {"a.ply", ply("")},
                                                                                    {"a.obj", obj("")}}) {
    SCOPED_TRACE(name);
    expect_corners(place(name, bytes, "", right), -1);
    EXPECT_THAT(messages_of(notes_),
                ElementsAre(HasSubstr("(RAS: 100 % of its points lie among the labels, 0 % as LPS;")));
    EXPECT_TRUE(notes_.all()[0].level() == NoteLevel::kWarning);
    expect_corners(place(name, bytes, "", left), 1);
    EXPECT_THAT(messages_of(notes_), ElementsAre(HasSubstr("(LPS: 100 %")));
    expect_corners(place(name, bytes), 1);
    EXPECT_THAT(messages_of(notes_), ElementsAre(HasSubstr("no frame and is read as LPS;")));
  }
}

/// Scale, then transform, then frame: (x, y, z) cm to (20 z + 1, 10 x + 2, 10 y + 3) mm in RAS.
TEST_F(MeshFrames, AreScaledAndTransformedBeforeTheyAreTurned) {
  write_bytes(folder_.file("t.txt"), "0 0 2 1\n1 0 0 2\n0 1 0 3\n0 0 0 1\n");
  const TriangleMesh mesh =
      place("a.obj", obj("# SPACE=RAS\n"), ",scale=10,transform=" + folder_.file("t.txt"));
  EXPECT_EQ(sum_of_corners(mesh), (Vec3{-3 * (20. * 36 + 4), -3 * (10. * 164 + 8), 3 * (10. * 88 + 12)}));
  EXPECT_EQ(volume_of(mesh), 2000 * 4 * 8 * 16);
}

TEST_F(MeshFrames, CommentsOfObjFilesNameTheUnit) {
  const std::string unit = "# vertex coordinates are measured in units, where 1 unit = 1000.000000 mm\n";
  EXPECT_EQ(volume_of(place("a.obj", obj(unit), ",frame=lps")), 1e9 * 4 * 8 * 16);
  EXPECT_EQ(volume_of(place("a.obj", obj(unit), ",frame=lps,scale=10")), 1e3 * 4 * 8 * 16);
}

TEST_F(MeshFrames, FreeSurferMovesToTheScanner) {
  std::string bytes = "\377\377\376created by a test\n\n" + big_endian(4) + big_endian(4);
  for (const Vec3& corner : kCorners) {
    for (const double mm : corner) bytes += big_endian(std::bit_cast<std::uint32_t>(static_cast<float>(mm)));
  }
  for (const auto& face : kFaces) {
    for (const int corner : face) bytes += big_endian(static_cast<std::uint32_t>(corner));
  }
  const auto footer = [](std::uint32_t is_scanner, const std::string& valid) {
    return big_endian(2) + big_endian(is_scanner) + big_endian(20) + "valid = " + valid +
           "  # volume info\nfilename = a.mgz\nsras   = 0 1 0\ncras   = 1.0e+00 2 3.0\n";
  };
  for (const std::string& end : {std::string(), footer(1, "1"), footer(0, "0")})
    expect_corners(place("lh.pial", bytes + end), -1);
  EXPECT_EQ(sum_of_corners(place("lh.pial", bytes + footer(0, "1"))), (Vec3{-3 * 168., -3 * 96., 3 * 48.}));
  EXPECT_THAT(messages_of(notes_), IsEmpty());
  write_bytes(folder_.file("lh.pial"), bytes.substr(0, bytes.size() - 1));
  EXPECT_THAT(read_mesh(folder_.file("lh.pial")).error().message, HasSubstr("truncated"));
}

TEST_F(MeshFrames, MirroredSurfacesKeepTheirOutside) {
  write_bytes(folder_.file("t.txt"), "-1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  const TriangleMesh mesh = place("a.stl", stl("SPACE=LPS"), ",transform=" + folder_.file("t.txt"));
  EXPECT_EQ(sum_of_corners(mesh), (Vec3{-3 * 164, 3 * 88, 3 * 36}));
  EXPECT_EQ(volume_of(mesh), 4 * 8 * 16);
}

TEST_F(MeshFrames, CutFilesAreRefused) {
  for (const std::size_t percent : {40u, 50u, 60u, 80u, 90u}) {
    write_bytes(folder_.file("a.vtp"), vtp("").substr(0, vtp("").size() * percent / 100));
    EXPECT_THAT(read_mesh(folder_.file("a.vtp")).error().message, HasSubstr("a.vtp")) << percent;
  }
}

TEST_F(MeshFrames, LegacyFilesHoldWhatTheyPromise) {
  const auto refusal = [&](const std::string& from, const std::string& to) {
    std::string bytes = vtk("x");
    bytes.replace(bytes.find(from), from.size(), to);
    write_bytes(folder_.file("a.vtk"), bytes);
    const Result<MeshFile> mesh = read_mesh(folder_.file("a.vtk"));
    return mesh ? "no error" : mesh.error().message;
  };
  for (const auto& [from, to] :
       std::vector<std::pair<std::string, std::string>>{{"POINTS 4", "POINTS 5"},
                                                        {"POINTS 4", "POINTS -1"},
                                                        {"POINTS 4", "POINTS 99999999999"},
                                                        {"POLYGONS 4 16", "POLYGONS 4 17"},
                                                        {"POLYGONS 4 16", "POLYGONS 5 16"},
                                                        {"POLYGONS 4 16", "POLYGONS 4 15"},
                                                        {"3 0 2 1", "9 0 2 1"},
                                                        {"3 0 2 1", "3 0 2 -1"},
                                                        {"3 0 2 1", "3 0 2 1e308"},
                                                        {"3 0 2 1", "3 0 2 1.5"},
                                                        {"3 1 2 3", "3 1 2 3.5"},
                                                        {"3 1 2 3", "4 1 2 3"},
                                                        {"POLYDATA", "UNSTRUCTURED_GRID"},
                                                        {"POINTS", "PINTS"}}) {
    SCOPED_TRACE(to);
    EXPECT_THAT(refusal(from, to), testing::StartsWith(folder_.file("a.vtk") + ": "));
  }
  EXPECT_EQ(refusal("POLYGONS", "METADATA\nINFORMATION 0\n\nPOLYGONS"), "no error");
}

}  // namespace
}  // namespace splatlas
