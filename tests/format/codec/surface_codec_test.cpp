#include "format/codec/surface_codec.h"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "format/content/unit_vector.h"
#include "tests/format/random_content.h"
#include "tests/support/fails_with.h"

namespace splatlas {
namespace {

constexpr Index3 kSize{10, 20, 30};

/// A tetrahedron with a corner at each allowed extreme.
SurfaceMesh tetrahedron() {
  SurfaceMesh mesh;
  mesh.positions_ijk = {{-1, -1, -1}, {10, 0, 0}, {0, 20, 0.5f}, {0, 0, 30}};
  mesh.normals_lps.assign(4, {0, 0, 1});
  mesh.triangles = {{0, 1, 2}, {3, 1, 0}, {2, 3, 0}, {1, 3, 2}};
  return mesh;
}

TEST(SurfaceCodec, KeepsEverythingExactly) {
  for (const std::uint32_t scale : {2u, 6u, 2000u, 65536u}) {  // positions in 16 and in 32 bits
    SurfaceMesh mesh = tetrahedron();
    mesh.position_scale = scale;
    const EncodedSurface encoded = encode_surface(mesh, kSize).value();
    EXPECT_EQ(encoded.entry.vertices, 4u);
    EXPECT_EQ(encoded.entry.triangles, 4u);
    EXPECT_EQ(encoded.entry.bytes, encoded.bytes.size());
    EXPECT_TRUE(check_surface_entry(encoded.entry, kSize));
    EXPECT_EQ(decode_surface(encoded.bytes, encoded.entry, kSize).value(), mesh) << scale;
  }
}

TEST(SurfaceCodec, AnEmptySurfaceTakesNoBytes) {
  const EncodedSurface encoded = encode_surface({}, kSize).value();
  EXPECT_TRUE(encoded.bytes.empty());
  EXPECT_TRUE(check_surface_entry(encoded.entry, kSize));
  EXPECT_EQ(decode_surface({}, encoded.entry, kSize).value(), SurfaceMesh{});
}

TEST(SurfaceCodec, LeavesTheRotationsOutWhenTrianglesReadSmallestFirst) {
  SurfaceMesh sorted = tetrahedron();
  sorted.triangles = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
  SurfaceMesh turned = sorted;
  turned.triangles[2] = {2, 3, 0};
  EXPECT_EQ(encode_surface(turned, kSize)->bytes.size(), encode_surface(sorted, kSize)->bytes.size() + 1);
}

RC_GTEST_PROP(SurfaceCodec, DecodesWhatWasEncoded, ()) {
  auto random = *random_source();
  const AtlasContent content = random_content(random, {12, 6, 2000});
  const Index3 size = storage_grid(content).size;
  for (const SurfaceMesh& mesh : content.surfaces) {
    const EncodedSurface encoded = encode_surface(mesh, size).value();
    RC_ASSERT(check_surface_entry(encoded.entry, size).has_value());
    RC_ASSERT(decode_surface(encoded.bytes, encoded.entry, size).value() == mesh);
  }
}

TEST(SurfaceCodec, PacksNormals) {
  SurfaceMesh mesh = tetrahedron();
  mesh.normals_lps[1] = {0.6f, 0, 0.8f};
  mesh.normals_lps[2] = {0, -3, 0};
  const EncodedSurface encoded = encode_surface(mesh, kSize).value();
  const SurfaceMesh decoded = decode_surface(encoded.bytes, encoded.entry, kSize).value();
  for (std::size_t v = 0; v < 4; ++v) {
    EXPECT_EQ(decoded.normals_lps[v], unpack_normal(pack_normal(mesh.normals_lps[v])));
  }
}

TEST(SurfaceCodec, RefusesMeshesThatCannotBeStored) {
  using Limits = std::numeric_limits<float>;
  struct Fault {
    void (*change)(SurfaceMesh& mesh);
    const char* part;
  };
  constexpr Fault kFaults[] = {
      {[](auto& m) { m.positions_ijk[2][0] = 10.5f; },
       "vertex 2 at (10.5, 20, 0.5) lies outside the grid of 10x20x30"},
      {[](auto& m) { m.positions_ijk[2][0] = -1.5f; }, "outside the grid"},
      {[](auto& m) { m.positions_ijk[2][0] = Limits::quiet_NaN(); }, "outside the grid"},
      {[](auto& m) { m.positions_ijk[2][0] = Limits::infinity(); }, "outside the grid"},
      {[](auto& m) { m.positions_ijk[2][0] = 1.25f; }, "not at multiples of 1/2 voxel"},
      {[](auto& m) { m.triangles[3][1] = 4; }, "triangle 3 has vertex 4 of 4"},
      {[](auto& m) { m.normals_lps.pop_back(); }, "3 normals of 4 vertices"},
      {[](auto& m) { m.normals_lps[1][1] = Limits::quiet_NaN(); }, "normal of vertex 1 is not finite"},
      {[](auto& m) { m.position_scale = 0; }, "position scale 0"},
      {[](auto& m) { m.position_scale = 1u << 28; }, "position scale 268435456"},  // times 31: over 32 bits
  };
  for (const auto& [change, part] : kFaults) {
    SurfaceMesh mesh = tetrahedron();
    change(mesh);
    EXPECT_THAT(encode_surface(mesh, kSize), FailsWith(ErrorCode::kFailed, HasSubstr(part)));
  }
}

TEST(SurfaceCodec, RefusesEveryPrefixAndEveryExtraByte) {
  SurfaceMesh mesh = tetrahedron();
  for (const std::uint32_t scale : {2u, 65536u}) {
    mesh.position_scale = scale;
    EncodedSurface encoded = encode_surface(mesh, kSize).value();
    for (std::size_t length = 0; length < encoded.bytes.size(); ++length) {
      const auto decoded = decode_surface(std::span(encoded.bytes).first(length), encoded.entry, kSize);
      // A stream without its last byte decodes to triangles of another orientation.
      EXPECT_TRUE(!decoded || (length + 1 == encoded.bytes.size() && *decoded != mesh)) << length;
    }
    encoded.bytes.push_back(std::byte{0});
    EXPECT_FALSE(decode_surface(encoded.bytes, encoded.entry, kSize));
  }
}

}  // namespace
}  // namespace splatlas
