#include "preprocess/export/write_mesh.h"

#include <stop_token>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "format/tasks/task_control.h"
#include "tests/support/committed.h"
#include "tests/support/fails_with.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

/// Two triangles of half a voxel, in a grid whose origin is far away.
Result<void> write_far_away(double origin_mm, double spacing_mm, const std::filesystem::path& path) {
  SurfaceMesh mesh;
  mesh.positions_ijk = {{0, 0, 0}, {0.5f, 0, 0}, {0, 0.5f, 0}, {0, 0, 0.5f}};
  mesh.normals_lps.assign(4, {0, 0, 1});
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  const Grid grid{.size = {2, 2, 2},
                  .spacing_mm = {spacing_mm, spacing_mm, spacing_mm},
                  .origin_lps_mm = {0, -origin_mm, 7}};
  return committed(write_mesh({&mesh, 1}, grid, path));
}

TEST(WriteMesh, EndsWithItsTask) {
  const TemporaryFolder folder;
  SurfaceMesh mesh;
  mesh.positions_ijk = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.normals_lps.assign(3, {0, 0, 1});
  mesh.triangles.assign(1 << 14, {0, 1, 2});
  std::stop_source stop;
  stop.request_stop();
  const TaskControl task(stop.get_token(), {});
  EXPECT_THROW(static_cast<void>(write_mesh({&mesh, 1}, {.size = {2, 2, 2}}, folder.file("a.stl"))),
               Cancelled);
  EXPECT_TRUE(folder.names().empty());
}

TEST(WriteMesh, IsExactOrTellsTheLargestCoordinate) {
  const TemporaryFolder folder;
  for (const std::string ending : {".stl", ".obj", ".ply", ".vtk"}) {
    SCOPED_TRACE(ending);
    const std::filesystem::path path = folder.path() / ("mesh" + ending);
    for (const auto& [mm, spacing_mm] : {std::pair{1e8, 1.0}, {1e15, 1.0}, {1.1e9, 1e6}}) {
      EXPECT_THAT(
          write_far_away(mm, spacing_mm, path),
          FailsWith(ErrorCode::kFailed,
                    AllOf(HasSubstr(path.string()), HasSubstr(fmt::format("coordinate of -{:.6g} mm", mm)),
                          HasSubstr("can always be written up to"), Not(HasSubstr("disk")))));
      EXPECT_TRUE(folder.names().empty());
    }
    for (const auto& [origin_mm, spacing_mm] : {std::pair{0.0, 1.0}, {1e3, 1.0}, {1e8, 1e6}, {9e8, 1e7}}) {
      SCOPED_TRACE(origin_mm);
      const Result<void> written = write_far_away(origin_mm, spacing_mm, path);
      EXPECT_TRUE(written) << written.error().message;
      const auto back = read_mesh(path);
      EXPECT_TRUE(back && back->mesh.triangles.size() == 2);
      std::filesystem::remove(path);
    }
  }
}

}  // namespace
}  // namespace splatlas
