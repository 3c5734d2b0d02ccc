// Fuzz target: untrusted surface streams, decoded to a valid mesh or refused.
// Input: width, height, depth (u16 each), position scale (u32), vertices and triangles (u16 each), the
// stream.
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "format/codec/surface_codec.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/require.h"

namespace splatlas {
namespace {

void check_mesh(const SurfaceMesh& mesh, const SurfaceEntry& entry, const Index3& size) {
  require(mesh.positions_ijk.size() == entry.vertices && mesh.normals_lps.size() == entry.vertices &&
              mesh.triangles.size() == entry.triangles && mesh.position_scale == entry.position_scale,
          "a mesh of other counts than the directory tells");
  for (const auto& position : mesh.positions_ijk) {
    for (std::size_t a = 0; a < 3; ++a)
      require(position[a] >= -1 && position[a] <= static_cast<float>(size[a]),
              "a vertex far outside the grid");
  }
  for (const auto& [x, y, z] : mesh.normals_lps)
    require(std::abs(std::hypot(x, y, z) - 1) < 1e-6f, "a normal that is not of unit length");
  for (const auto& triangle : mesh.triangles)
    require(std::ranges::max(triangle) < entry.vertices, "a triangle with a vertex that does not exist");
}

void fuzz_surfaces(FuzzInput input) {
  Index3 size{};
  for (std::int64_t& n : size) n = 1 + std::int64_t{input.number<std::uint16_t>()};
  SurfaceEntry entry;
  entry.position_scale = input.number<std::uint32_t>();
  entry.vertices = input.number<std::uint16_t>();
  entry.triangles = input.number<std::uint16_t>();
  const auto stream = input.rest();
  entry.bytes = static_cast<std::uint32_t>(stream.size());
  if (const auto fits = check_surface_entry(entry, size); !fits)
    return require_error(fits.error(), {ErrorCode::kInvalidAtlas});
  if (is_fitted(entry)) return;

  const auto mesh = decode_surface(stream, entry, size);
  if (!mesh) return require_error(mesh.error(), {ErrorCode::kInvalidAtlas});
  check_mesh(*mesh, entry, size);
  const EncodedSurface again = require_value(encode_surface(*mesh, size));
  require(check_surface_entry(again.entry, size).has_value(), "an encoded surface does not fit its entry");
  require(require_value(decode_surface(again.bytes, again.entry, size)) == *mesh,
          "a surface decodes to another one");
}

const FuzzTarget kSurfaces("surfaces", fuzz_surfaces);

}  // namespace
}  // namespace splatlas
