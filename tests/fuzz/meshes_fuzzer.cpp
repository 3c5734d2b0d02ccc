// Fuzz target: untrusted mesh files. Input: a byte of choices, then the file.
#include <array>
#include <cmath>
#include <cstdint>

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
  for (const CornerNormals& normals : corner_normals(mesh)) {
    for (const auto& normal : normals)
      for (const float n : normal) require(std::abs(n) <= 1.0001f, "an invalid normal");
  }
}

void fuzz_meshes(FuzzInput input) {
  const auto choices = input.number<std::uint8_t>();
  const auto path = write_input_file("mesh", input.rest());
  constexpr std::array kFormats{MeshFormat::kStl, MeshFormat::kObj, MeshFormat::kFreeSurfer,
                                MeshFormat::kGifti};
  auto file = read_mesh_here(path, kFormats[choices % 4]);
  if (!file) return require_error(file.error(), {ErrorCode::kFailed});
  to_lps(file->mesh, (choices & 0x80) != 0 ? MeshFrame::kRas : MeshFrame::kLps);
  check_mesh(file->mesh);
}

const FuzzTarget kMeshes("meshes", fuzz_meshes);

}  // namespace
}  // namespace splatlas
