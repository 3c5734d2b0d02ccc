#include "preprocess/import/meshes/import_mesh.h"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "preprocess/export/write_mesh.h"
#include "tests/preprocess/random_images.h"
#include "tests/preprocess/raw_image_files.h"
#include "tests/support/committed.h"
#include "tests/support/fails_with.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

class ImportMesh : public testing::Test {
 protected:
  Result<TriangleMesh> import_bytes(const std::string& name, const std::string& bytes,
                                    MeshFrame frame = MeshFrame::kLps) const {
    write_bytes(folder_.file(name), bytes);
    Result<MeshFile> file = read_mesh(folder_.file(name));
    if (!file) return tl::unexpected(file.error());
    to_lps(file->mesh, frame);
    return std::move(file->mesh);
  }
  std::string error(const std::string& name, const std::string& bytes) const {
    const auto mesh = import_bytes(name, bytes);
    return mesh ? "no error" : mesh.error().message;
  }
  TemporaryFolder folder_;
};

constexpr const char* kSquareObj = "# a square\nv 0 0 1\nv 2 0 1\nv 2 3 1\nv 0 3 1\nf 1 2 3 4\n";

constexpr std::array<float, 3> kUp{0, 0, 1};
constexpr CornerNormals kUpwards{kUp, kUp, kUp};

std::string binary_stl(std::uint32_t triangles, std::uint32_t promised) {
  std::string bytes(80, ' ');
  bytes.append(reinterpret_cast<const char*>(&promised), 4);
  for (std::uint32_t t = 0; t < triangles; ++t) {
    const std::array<float, 12> numbers{0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, static_cast<float>(t)};
    bytes.append(reinterpret_cast<const char*>(numbers.data()), 48);
    bytes.append(2, '\0');
  }
  return bytes;
}

TEST_F(ImportMesh, PolygonsBecomeTriangles) {
  const auto mesh = value_or_throw(import_bytes("a.obj", kSquareObj));
  EXPECT_EQ(mesh.positions_lps_mm.size(), 4u);
  ASSERT_EQ(mesh.triangles.size(), 2u);
  EXPECT_EQ(mesh.dropped, 0u);
  EXPECT_TRUE(mesh.normals_lps.empty());
  for (const CornerNormals& normals : corner_normals(mesh)) EXPECT_EQ(normals, kUpwards);
}

TEST_F(ImportMesh, ObjNeedsNeitherTexturesNorNormals) {
  const std::string vertices = "v 0 0 1\nv 2 0 1\nv 2 3 1\nv 0 3 1\n";
  const auto square = import_bytes("a.obj", kSquareObj);
  for (const std::string face :
       {"f 1// 2// 3// 4//", "f 1//0 2//0 3//0 4//0", "f 1/ 2/ 3/ 4/", "f 1/0/0 2/0/0 3/0/0 4/0/0",
        "f -4/7 -3/7 -2/7 -1/7", "vn 0 0 1\nf 1//1 2//1 3//1 4//9"}) {
    const auto mesh = value_or_throw(import_bytes("b.obj", vertices + face + "\n"));
    EXPECT_EQ(mesh.positions_lps_mm, square->positions_lps_mm) << face;
    EXPECT_EQ(mesh.triangles, square->triangles) << face;
  }
  // Corners with two normals split their vertices.
  const auto mesh =
      import_bytes("b.obj", vertices + "vn 0 0 1\nvn 1 0 0\nf 1//1 2//1 3//1\nf 1//2 3//2 4//2\n");
  ASSERT_EQ(mesh->positions_lps_mm.size(), 6u);
  EXPECT_EQ(mesh->normals_lps[mesh->triangles[1][1]], (std::array<float, 3>{1, 0, 0}));
}

TEST_F(ImportMesh, StlMayBeInCapitals) {
  const auto mesh =
      value_or_throw(import_bytes("a.stl",
                                  " SOLID A B\nFACET NORMAL 0 0 1\nOUTER LOOP\nVERTEX 0 0 1\nVERTEX 2E0 0 1\n"
                                  "VERTEX 2 3 1\nENDLOOP\nENDFACET\nENDSOLID A B\n"));
  EXPECT_EQ(mesh.positions_lps_mm, (std::vector<Vec3>{{0, 0, 1}, {2, 0, 1}, {2, 3, 1}}));
}

TEST_F(ImportMesh, RasIsTurnedAndKeepsItsOutside) {
  const auto mesh = value_or_throw(import_bytes("a.obj", kSquareObj, MeshFrame::kRas));
  EXPECT_EQ(mesh.positions_lps_mm[2], (Vec3{-2, -3, 1}));
  for (const CornerNormals& normals : corner_normals(mesh)) EXPECT_EQ(normals, kUpwards);
}

/// Two triangles of equal areas at the x axis, the second turned around it.
TriangleMesh folded(double degrees) {
  const double angle = degrees * std::numbers::pi / 180;
  TriangleMesh mesh;
  mesh.positions_lps_mm = {{0, 0, 0}, {2, 0, 0}, {1, 1, 0}, {1, -std::cos(angle), -std::sin(angle)}};
  mesh.triangles = {{0, 1, 2}, {1, 0, 3}};
  return mesh;
}

TEST_F(ImportMesh, NormalsEndAtEdgesAbove60Degrees) {
  // The normal of the second triangle is (0, -sin, cos); the mean of both has half of the angle.
  for (const double degrees : {59.0, 61.0}) {
    const double shared = degrees < 60 ? degrees / 2 * std::numbers::pi / 180 : 0;
    const std::vector<CornerNormals> normals = corner_normals(folded(degrees));
    EXPECT_EQ(normals[0][2], kUp);
    for (const std::size_t corner : {0u, 1u}) {
      EXPECT_NEAR(normals[0][corner][1], -std::sin(shared), 1e-6) << degrees;
      EXPECT_NEAR(normals[0][corner][2], std::cos(shared), 1e-6) << degrees;
    }
  }
}

TEST_F(ImportMesh, ReadsWhatItWrites) {
  const Grid grid = awkward_grid(0.2);
  SurfaceMesh surface;
  surface.positions_ijk = {{0, 0, 0}, {3, 0, 0.5f}, {0, 3, 0}, {1, 1, 2}};
  surface.normals_lps = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.6f, 0.8f, 0}};
  surface.triangles = {{0, 1, 2}, {1, 2, 3}, {0, 3, 1}};
  for (const std::string name : {"a.stl", "a.ply", "a.obj", "a.vtk"}) {
    SCOPED_TRACE(name);
    const Result<void> written =
        committed(write_mesh(std::vector{surface, surface}, grid, folder_.file(name)));
    ASSERT_TRUE(written) << written.error().message;
    const auto back = value_or_throw(import_bytes(name, read_bytes(folder_.file(name))));
    ASSERT_EQ(back.triangles.size(), 6u);
    for (std::size_t t = 0; t < 3; ++t) {
      for (std::size_t n = 0; n < 3; ++n) {
        const auto& [i, j, k] = surface.positions_ijk[surface.triangles[t][n]];
        const Vec3 expected = index_to_lps_mm(grid).apply({i, j, k});
        // Writers choose the first corner of a triangle; the order is fixed.
        bool found = false;
        for (std::size_t turn = 0; turn < 3; ++turn) {
          const Vec3& at = back.positions_lps_mm[back.triangles[t][turn]];
          found = found || std::hypot(at[0] - expected[0], at[1] - expected[1], at[2] - expected[2]) < 1e-4;
        }
        EXPECT_TRUE(found);
      }
    }
  }
  const auto vtk = import_bytes("a.vtk", read_bytes(folder_.file("a.vtk")));
  ASSERT_EQ(vtk->normals_lps.size(), 8u);
  EXPECT_NEAR(vtk->normals_lps[3][1], 0.8, 1e-6);
}

TEST_F(ImportMesh, TrianglesWithoutAreaOrPlaceAreCounted) {
  const auto mesh = value_or_throw(import_bytes("a.obj",
                                                "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nv nan 0 0\nv 1e30 0 0\n"
                                                "f 1 2 3\nf 1 2 4\nf 1 2 2\nf 1 2 5\nf 1 2 6\n"));
  EXPECT_EQ(mesh.triangles.size(), 1u);
  EXPECT_GE(mesh.dropped, 2u);  // VTK itself may drop some
}

TEST_F(ImportMesh, ABackslashContinuesALineOfObj) {
  for (const std::string end : {"\n", "\r\n"}) {
    const std::string continued =
        "v 0 0 \\" + end + "1\nv 2 0 1\nv 2 3 1\nv 0 3 1\nf 1 2\\" + end + "3 \\" + end + "4\n";
    const auto mesh = value_or_throw(import_bytes("a.obj", continued));
    EXPECT_EQ(mesh.positions_lps_mm, import_bytes("b.obj", kSquareObj)->positions_lps_mm);
    EXPECT_EQ(mesh.triangles.size(), 2u);
    EXPECT_THAT(error("a.obj", continued + "f 1 \\" + end + "2 9\n"), HasSubstr("line 9: corner '9'"));
  }
  EXPECT_THAT(error("a.obj", std::string(kSquareObj) + "f 1 2 3 \\"), HasSubstr("line 7"));
  // But not a comment: many end in a folder's name.
  const auto mesh = value_or_throw(import_bytes("c.obj", "# C:\\models\\\n" + std::string(kSquareObj)));
  EXPECT_EQ(mesh.positions_lps_mm, import_bytes("b.obj", kSquareObj)->positions_lps_mm);
}

TEST_F(ImportMesh, RefusesDamagedFiles) {
  EXPECT_THAT(error("a.stl", binary_stl(3, 4)), AllOf(HasSubstr("a.stl"), HasSubstr("truncated")));
  EXPECT_THAT(error("a.stl", binary_stl(3, 0xffffffff)), HasSubstr("truncated"));
  EXPECT_THAT(error("a.stl", "short"), HasSubstr("STL"));
  // Text for our check, but VTK would take these bytes for binary, and some of them for a triangle count.
  EXPECT_THAT(error("a.stl", "solid a\nfacet normal 0 0 1\n" + std::string(100, '\x9b')),
              HasSubstr("truncated"));
  EXPECT_TRUE(import_bytes("a.stl", binary_stl(3, 3)));
  EXPECT_THAT(error("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n"),
              AllOf(HasSubstr("line 4"), HasSubstr("'4'")));
  EXPECT_THAT(error("a.obj", "v 0 0 0\nf 0 1 1\n"), HasSubstr("'0'"));
  EXPECT_THAT(error("a.obj", "v 0 0 0\nf -2 1 1\n"), HasSubstr("'-2'"));
  EXPECT_THAT(error("a.obj", "hello\n"), HasSubstr("OBJ"));
  EXPECT_THAT(error("a.vtk", "hello\n"), HasSubstr("Unrecognized file type"));
  EXPECT_THAT(error("a.vtk",
                    "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n"
                    "0 0 0 1 0 0 0 1 0\nPOLYGONS 1 4\n3 0 1 7\n"),
              HasSubstr("corner 7"));
  EXPECT_THAT(error("a.xyz", "1 2 3\n"), HasSubstr("known type"));
  EXPECT_THAT(read_mesh(folder_.file("missing.stl")).error().message, HasSubstr("no such file"));
}

std::string ply(const std::string& format, const std::string& list, const std::string& body) {
  return "ply\nformat " + format +
         " 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n" +
         "element face 1\nproperty list " + list + "\nend_header\n" + body;
}

TEST_F(ImportMesh, PlyIsWholeOrRefused) {
  const std::string zero(4, '\0'), one("\x3f\x80\0\0", 4);  // big endian
  const std::string text = "0 0 0\n1 0 0\n0 1 0\n1 1 0\n", list = "uchar char vertex_indices";
  const std::string binary = zero + zero + zero + one + zero + zero + zero + one + zero + one + one + zero;
  for (const std::string& bytes :
       {ply("ascii", list, text + "4 1 0 2 2\n"),
        ply("ascii", "int int32 vertex_index", text + "3 1 0 2 0.5\n"),
        ply("binary_big_endian", list, binary + "\3" + std::string("\1\0\2", 3))}) {
    const auto mesh = value_or_throw(import_bytes("a.ply", bytes));
    EXPECT_EQ(mesh.positions_lps_mm, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}));
    EXPECT_EQ(mesh.triangles[0], (std::array<std::uint32_t, 3>{1, 0, 2}));
  }
  const auto refuses = [&](const std::string& bytes, const std::string& reason) {
    EXPECT_THAT(error("a.ply", bytes), AllOf(StartsWith(folder_.file("a.ply") + ": "), HasSubstr(reason)))
        << bytes;
  };
  for (const std::string face : {"3 0 1 x", "3 0 1.5 2", "3 0 1", "3 0\r 1 2", "3 0\v1 2", "300 0 1 2", ""})
    refuses(ply("ascii", "int int vertex_indices", text + face + "\n"), "line 14 is not");
  for (const std::string corner : {"4", "-1", "4294967295"})
    refuses(ply("ascii", list, text + "3 0 1 " + corner), "");
  for (const std::string vertices : {"0 0\n0 0 0\n", "0 0 0 0\n0 0 0\n", "\n0 0 0\n"})
    refuses(ply("ascii", list, vertices + text), "line 10 is not");
  for (const std::string wrong : {"int uchar", "uchar int64", "uchar int\v"})
    refuses(ply("binary_little_endian", wrong + " vertex_indices", binary + "\3\1\1\2"), "line 8 is not");
  for (const std::string face : {"\3\1\2\4", "\3\1\2\xff", "\3\1\2", "\xc8\1\1\2"})
    refuses(ply("binary_big_endian", list, binary + face), "");
  refuses("ply\nformat ascii 1.0\nelement camera 1\n", "line 3 is not");
}

TEST_F(ImportMesh, NoTruncationBringsItDown) {
  SurfaceMesh surface;
  surface.positions_ijk = {{0, 0, 0}, {3, 0, 0.5f}, {0, 3, 0}, {1, 1, 2}};
  surface.normals_lps.resize(4, {0, 0, 1});
  surface.triangles = {{0, 1, 2}, {1, 2, 3}};
  for (const std::string name : {"a.stl", "a.ply", "a.vtk"}) {
    ASSERT_TRUE(committed(write_mesh(std::span(&surface, 1), awkward_grid(0), folder_.file(name))));
    const std::string bytes = read_bytes(folder_.file(name));
    for (std::size_t length = 0; length < bytes.size(); ++length) {
      const auto mesh = import_bytes(name, bytes.substr(0, length));
      if (!mesh) continue;  // the rest may be irrelevant, but is never a triangle
      EXPECT_EQ(mesh->triangles.size(), 2u) << name << " cut to " << length;
    }
  }
}

}  // namespace
}  // namespace splatlas
