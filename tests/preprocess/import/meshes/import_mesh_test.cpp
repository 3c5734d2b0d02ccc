#include "preprocess/import/meshes/import_mesh.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "preprocess/export/write_mesh.h"
#include "tests/preprocess/random_images.h"
#include "tests/preprocess/raw_image_files.h"
#include "tests/support/committed.h"
#include "tests/support/run_program.h"

namespace splatlas {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class ImportMesh : public testing::Test {
 protected:
  Result<TriangleMesh> import_bytes(const std::string& name, const std::string& bytes,
                                    MeshFrame frame = MeshFrame::kLps) const {
    write_bytes(folder_.file(name), bytes);
    return import_mesh(folder_.file(name), frame);
  }
  std::string error(const std::string& name, const std::string& bytes) const {
    const auto mesh = import_bytes(name, bytes);
    return mesh ? "no error" : mesh.error().message;
  }
  TemporaryFolder folder_;
};

constexpr const char* kSquareObj = "# a square\nv 0 0 1\nv 2 0 1\nv 2 3 1\nv 0 3 1\nf 1 2 3 4\n";

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
  const auto mesh = import_bytes("a.obj", kSquareObj);
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->positions_lps_mm.size(), 4u);
  ASSERT_EQ(mesh->triangles.size(), 2u);
  EXPECT_EQ(mesh->dropped, 0u);
  EXPECT_TRUE(mesh->normals_lps.empty());
  for (const auto& normal : vertex_normals(*mesh)) EXPECT_EQ(normal, (std::array<float, 3>{0, 0, 1}));
}

TEST_F(ImportMesh, RasIsTurnedAndKeepsItsOutside) {
  const auto mesh = import_bytes("a.obj", kSquareObj, MeshFrame::kRas);
  ASSERT_TRUE(mesh);
  EXPECT_EQ(mesh->positions_lps_mm[2], (Vec3{-2, -3, 1}));
  for (const auto& normal : vertex_normals(*mesh)) EXPECT_EQ(normal, (std::array<float, 3>{0, 0, 1}));
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
    const auto back = import_mesh(folder_.file(name), MeshFrame::kLps);
    ASSERT_TRUE(back) << back.error().message;
    ASSERT_EQ(back->triangles.size(), 6u);
    for (std::size_t t = 0; t < 3; ++t) {
      for (std::size_t n = 0; n < 3; ++n) {
        const auto& [i, j, k] = surface.positions_ijk[surface.triangles[t][n]];
        const Vec3 expected = index_to_lps_mm(grid).apply({i, j, k});
        // Writers choose the first corner of a triangle; the order is fixed.
        bool found = false;
        for (std::size_t turn = 0; turn < 3; ++turn) {
          const Vec3& at = back->positions_lps_mm[back->triangles[t][turn]];
          found = found || std::hypot(at[0] - expected[0], at[1] - expected[1], at[2] - expected[2]) < 1e-4;
        }
        EXPECT_TRUE(found);
      }
    }
  }
  const auto vtk = import_mesh(folder_.file("a.vtk"), MeshFrame::kLps);
  ASSERT_EQ(vtk->normals_lps.size(), 8u);
  EXPECT_NEAR(vtk->normals_lps[3][1], 0.8, 1e-6);
}

TEST_F(ImportMesh, TrianglesWithoutAreaOrPlaceAreCounted) {
  const auto mesh = import_bytes("a.obj",
                                 "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nv nan 0 0\nv 1e30 0 0\n"
                                 "f 1 2 3\nf 1 2 4\nf 1 2 2\nf 1 2 5\nf 1 2 6\n");
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->triangles.size(), 1u);
  EXPECT_GE(mesh->dropped, 2u);  // VTK itself may drop some
}

TEST_F(ImportMesh, ABackslashContinuesALineOfObj) {
  for (const std::string end : {"\n", "\r\n"}) {
    const std::string continued =
        "v 0 0 \\" + end + "1\nv 2 0 1\nv 2 3 1\nv 0 3 1\nf 1 2\\" + end + "3 \\" + end + "4\n";
    const auto mesh = import_bytes("a.obj", continued);
    ASSERT_TRUE(mesh) << mesh.error().message;
    EXPECT_EQ(mesh->positions_lps_mm, import_bytes("b.obj", kSquareObj)->positions_lps_mm);
    EXPECT_EQ(mesh->triangles.size(), 2u);
    EXPECT_THAT(error("a.obj", continued + "f 1 \\" + end + "2 9\n"), HasSubstr("line 9: corner '9'"));
  }
  EXPECT_THAT(error("a.obj", std::string(kSquareObj) + "f 1 2 3 \\"), HasSubstr("line 7"));
  // But not a comment: many end in a folder's name.
  const auto mesh = import_bytes("c.obj", "# C:\\models\\\n" + std::string(kSquareObj));
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->positions_lps_mm, import_bytes("b.obj", kSquareObj)->positions_lps_mm);
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
  EXPECT_THAT(error("a.obj", "v 0 0 0\nf 1/7 1 1\n"), HasSubstr("1/7"));
  EXPECT_THAT(error("a.obj", "v 0 0 0\nf 0 1 1\n"), HasSubstr("'0'"));
  EXPECT_THAT(error("a.obj", "v 0 0 0\nf -2 1 1\n"), HasSubstr("'-2'"));
  // Found by fuzzing: VTK joins a trailing slash with the number after the blank.
  EXPECT_THAT(error("a.obj", "v 0 0 0\nf 1 1/ 1\n"), HasSubstr("corner '1/' does not exist"));
  EXPECT_THAT(error("a.obj", "v 0 0 0\nf 1 1// 1\n"), HasSubstr("corner '1//' does not exist"));
  EXPECT_THAT(error("a.obj", "hello\n"), HasSubstr("OBJ"));
  EXPECT_THAT(error("a.ply", "hello\n"), HasSubstr("PLY"));
  EXPECT_THAT(error("a.ply",
                    "ply\nformat binary_little_endian 1.0\nelement vertex 1000000\nproperty float x\n"
                    "property float y\nproperty float z\nelement face 9\n"
                    "property list uchar int vertex_indices\nend_header\n"),
              HasSubstr("truncated"));
  const auto ply = [](const std::string& format, const std::string& corner_type, const std::string& body) {
    return "ply\nformat " + format + " 1.0\nelement vertex 3\nproperty float x\nproperty float y\n" +
           "property float z\nelement face 1\nproperty list uchar " + corner_type +
           " vertex_indices\nend_header\n" + body;
  };
  const std::string zero(4, '\0'), one("\x3f\x80\0\0", 4);  // big endian
  const std::string text = "0 0 0\n1 0 0\n0 1 0\n";
  const std::string binary = zero + zero + zero + one + zero + zero + zero + one + zero;
  EXPECT_TRUE(import_bytes("a.ply", ply("ascii", "int", text + "3 0 1 2\n")));
  std::string other_name = ply("ascii", "int", text + "3 0 1 2\n");
  other_name.replace(other_name.find("vertex_indices"), 14, "vertex_index");
  EXPECT_TRUE(import_bytes("a.ply", other_name));
  EXPECT_TRUE(
      import_bytes("a.ply", ply("binary_big_endian", "char", binary + "\3" + std::string("\0\1\2", 3))));
  for (const std::string corner : {"3", "-1", "4294967295", "x"}) {
    EXPECT_THAT(error("a.ply", ply("ascii", "int", text + "3 0 1 " + corner + "\n")), HasSubstr("corners"));
  }
  for (const char control :
       {'\0', '\1', '\r', '\v'}) {  // VTK may take the rest for another line, or for none
    EXPECT_THAT(error("a.ply", ply("ascii", "int", text + "3 0" + control + " 1 2\n")), HasSubstr("damaged"));
    EXPECT_THAT(error("a.ply", ply("ascii", "int" + std::string(1, control), text + "3 0 1 2\n")),
                HasSubstr("no PLY"));
  }
  for (const std::string corner : {"\3", "\xff"}) {
    const std::string body = binary + "\3" + std::string("\0\1", 2) + corner;
    EXPECT_THAT(error("a.ply", ply("binary_little_endian", "char", body)), HasSubstr("corners"));
    EXPECT_THAT(error("a.ply", ply("binary_big_endian", "uchar", body)), HasSubstr("corners"));
  }
  for (const std::string count_type : {"char", "uchar"}) {  // of 200 corners, beyond a char
    std::string file = ply("binary_little_endian", "uchar", binary + "\xc8" + std::string(200, '\1'));
    file.replace(file.find("list uchar"), 10, "list " + count_type);
    EXPECT_THAT(error("a.ply", file), HasSubstr(count_type == "char" ? "damaged" : "no triangle"));
  }
  EXPECT_THAT(error("a.ply",
                    "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\n"
                    "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
                    "3 0 1 2\n" +
                        text),
              HasSubstr("vertices"));
  EXPECT_THAT(error("a.vtk", "hello\n"), HasSubstr("Unrecognized file type"));
  EXPECT_THAT(error("a.vtk",
                    "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n"
                    "0 0 0 1 0 0 0 1 0\nPOLYGONS 1 4\n3 0 1 7\n"),
              HasSubstr("corner 7"));
  EXPECT_THAT(error("a.xyz", "1 2 3\n"), HasSubstr("known type"));
  EXPECT_THAT(import_mesh(folder_.file("missing.stl"), MeshFrame::kLps).error().message,
              HasSubstr("no such file"));
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
