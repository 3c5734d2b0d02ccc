// Fuzz target: untrusted mesh files.
// Input: a byte of choices, then the file.
#include <array>
#include <cmath>
#include <cstdint>
#include <string>

#include "preprocess/import/meshes/import_mesh.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/require.h"
#include "tests/fuzz/scratch_file.h"

namespace splatlas {
namespace {

void check_mesh(const TriangleMesh& mesh) {
  require(!mesh.triangles.empty(), "a mesh without triangles");
  require(mesh.normals_lps.empty() || mesh.normals_lps.size() == mesh.positions_lps_mm.size(),
          "normals of other points");
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) {
      require(corner < mesh.positions_lps_mm.size(), "a corner that does not exist");
      for (const double mm : mesh.positions_lps_mm[corner]) require(std::abs(mm) <= 1e9, "a corner far away");
    }
  }
  for (const auto& normal : vertex_normals(mesh)) {
    for (const float n : normal) require(std::abs(n) <= 1.0001f, "an invalid normal");
  }
}

void fuzz_meshes(FuzzInput input) {
  static const std::array<std::string, 4> kNames{"mesh.stl", "mesh.obj", "mesh.ply", "mesh.gii"};
  const auto choices = input.number<std::uint8_t>();
  const auto path = write_input_file(kNames[choices % 4], input.rest());
  const auto mesh = import_mesh(path, (choices & 0x80) != 0 ? MeshFrame::kRas : MeshFrame::kLps);
  if (!mesh) return require_error(mesh.error(), {ErrorCode::kFailed});
  check_mesh(*mesh);
}

const FuzzTarget kMeshes("meshes", fuzz_meshes);

}  // namespace
}  // namespace splatlas
