// Invalid files: tables of surfaces, scenes, sections and chunks.
#include <limits>
#include <utility>

#include <gtest/gtest.h>

#include "tests/format/bad_files/bad_files.h"

namespace splatlas {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

constexpr BadFile kSurfaces[] = {
    {"of one structure too few", [](RawAtlas& a) { a.directory.surfaces.pop_back(); },
     "F: invalid: 4 surfaces of 5 structures"},
    {"of one structure too many",
     [](RawAtlas& a) {
       a.directory.surfaces.push_back({0, 0, 2, 0});
     },
     "F: invalid: 6 surfaces of 5 structures"},
    {"of no structures", [](RawAtlas& a) { a.directory.surfaces.clear(); },
     "F: invalid: 0 surfaces of 5 structures"},
    {"triangles without vertices", [](RawAtlas& a) { a.directory.surfaces[good::kAll].triangles = 1; },
     "F: invalid: surface of structure 'all': no vertices, 1 triangles, 0 bytes"},
    {"bytes without vertices", [](RawAtlas& a) { a.directory.surfaces[good::kAll].bytes = 8; },
     "F: invalid: surface of structure 'all': no vertices, 0 triangles, 8 bytes"},
    {"no position scale", [](RawAtlas& a) { a.directory.surfaces[good::kRim].position_scale = 0; },
     "F: invalid: surface of structure 'rim': position scale 0"},
    {"no position scale of a group", [](RawAtlas& a) { a.directory.surfaces[good::kAll].position_scale = 0; },
     "F: invalid: surface of structure 'all': position scale 0"},
    {"the largest position scale",
     [](RawAtlas& a) { a.directory.surfaces[good::kRim].position_scale = 0xffffffff; },
     "F: invalid: surface of structure 'rim': position scale 4294967295"},
    {"another position scale of a fitted one",
     [](RawAtlas& a) { a.directory.surfaces[good::kCore].position_scale = 3; },
     "F: invalid: surface of structure 'core': fitted, with position scale 3 and 104 triangles"},
    {"a fitted one without triangles", [](RawAtlas& a) { a.directory.surfaces[good::kCore].triangles = 0; },
     "F: invalid: surface of structure 'core': fitted, with position scale 2 and 0 triangles"},
    {"a fitted one with a vertex more", [](RawAtlas& a) { ++a.directory.surfaces[good::kCore].vertices; },
     "F: invalid: surface of structure 'core': 55 vertices and 104 triangles, its voxels give 54 and 104"},
    {"a fitted one with a triangle less", [](RawAtlas& a) { --a.directory.surfaces[good::kKnob].triangles; },
     "F: invalid: surface of structure 'knob': 54 vertices and 103 triangles, its voxels give 54 and 104"},
    {"a fitted one with maximum vertices and triangles",
     [](RawAtlas& a) {
       a.directory.surfaces[good::kKnob] = {0xffffffff, 0xffffffff, 2, 0};
     },
     "F: invalid: surface of structure 'knob': 4294967295 vertices and 4294967295 triangles, its voxels give "
     "54 and 104"},
    {"a fitted one of a group without voxels",
     [](RawAtlas& a) {
       a.directory.surfaces[good::kAll] = {3, 1, 2, 0};
     },
     "F: invalid: surface of structure 'all': 3 vertices and 1 triangles, its voxels give 0 and 0"},
    {"fitted where they are stored",
     [](RawAtlas& a) {
       a.directory.surfaces[good::kRim].bytes = a.directory.surfaces[good::kNeedle].bytes = 0;
     },
     "F: invalid: surface of structure 'needle': fitted, with position scale 8192 and 2 triangles"},
    {"more triangles than its bytes can hold",
     [](RawAtlas& a) { a.directory.surfaces[good::kRim].triangles = 1000; },
     "F: invalid: surface of structure 'rim': 86 bytes for 4 vertices and 1000 triangles"},
    {"more vertices than its bytes can hold",
     [](RawAtlas& a) { a.directory.surfaces[good::kRim].vertices = 100000; },
     "F: invalid: surface of structure 'rim': 86 bytes for 100000 vertices and 2 triangles"},
    {"maximum counts",
     [](RawAtlas& a) {
       a.directory.surfaces[good::kRim] = {0xffffffff, 0xffffffff, 2, 0xffffffff};
     },
     "F: invalid: surface of structure 'rim': 4294967295 bytes for 4294967295 vertices and 4294967295 "
     "triangles"},
    {"more bytes than its triangles need",
     [](RawAtlas& a) { a.directory.surfaces[good::kRim].bytes = 100000; },
     "F: invalid: surface of structure 'rim': 100000 bytes for 4 vertices and 2 triangles"},
    {"one byte more", [](RawAtlas& a) { ++a.directory.surfaces[good::kRim].bytes; },
     "F: damaged: wrong frame length (expected 181 bytes) of surfaces of structures 'rim' "
     "to 'needle'"},
    {"one vertex more, which decodes", [](RawAtlas& a) { ++a.directory.surfaces[good::kRim].vertices; }, ""},
    {"one vertex less", [](RawAtlas& a) { --a.directory.surfaces[good::kRim].vertices; },
     "F: invalid: surface of structure 'rim': triangle 1 has vertex 3 of 3"},
    {"one triangle more", [](RawAtlas& a) { ++a.directory.surfaces[good::kRim].triangles; },
     "F: invalid: surface of structure 'rim': triangles cannot be decoded"},
    {"one triangle less", [](RawAtlas& a) { --a.directory.surfaces[good::kRim].triangles; },
     "F: invalid: surface of structure 'rim': triangles cannot be decoded"},
    {"a position scale of other vertices",
     [](RawAtlas& a) { a.directory.surfaces[good::kRim].position_scale = 8192; },
     "F: invalid: surface of structure 'rim': vertices cannot be decoded"},
};

constexpr BadFile kScenes[] = {
    {"azimuth no number", [](RawAtlas& a) { a.directory.scenes[0].azimuth_deg = kNan; },
     "F: invalid: camera of scene 0: azimuth nan, elevation 20, zoom 1.5"},
    {"azimuth infinite", [](RawAtlas& a) { a.directory.scenes[0].azimuth_deg = kInf; },
     "F: invalid: camera of scene 0: azimuth inf, elevation 20, zoom 1.5"},
    {"elevation no number", [](RawAtlas& a) { a.directory.scenes[0].elevation_deg = kNan; },
     "F: invalid: camera of scene 0: azimuth 30, elevation nan, zoom 1.5"},
    {"elevation infinite", [](RawAtlas& a) { a.directory.scenes[0].elevation_deg = -kInf; },
     "F: invalid: camera of scene 0: azimuth 30, elevation -inf, zoom 1.5"},
    {"no zoom", [](RawAtlas& a) { a.directory.scenes[0].zoom = 0; },
     "F: invalid: camera of scene 0: azimuth 30, elevation 20, zoom 0"},
    {"zoom negative", [](RawAtlas& a) { a.directory.scenes[0].zoom = -1; },
     "F: invalid: camera of scene 0: azimuth 30, elevation 20, zoom -1"},
    {"zoom no number", [](RawAtlas& a) { a.directory.scenes[0].zoom = kNan; },
     "F: invalid: camera of scene 0: azimuth 30, elevation 20, zoom nan"},
    {"zoom infinite", [](RawAtlas& a) { a.directory.scenes[0].zoom = kInf; },
     "F: invalid: camera of scene 0: azimuth 30, elevation 20, zoom inf"},
};

constexpr BadFile kSections[] = {
    {"no runs along x, but their lengths", [](RawAtlas& a) { a.section(SectionKind::kRunsX).kind = 77; },
     "F: invalid: runs of class 1 along axis 0 take 4 bytes for 0 voxels"},
    {"no runs along y, but their lengths", [](RawAtlas& a) { a.section(SectionKind::kRunsY).kind = 77; },
     "F: invalid: runs of class 1 along axis 1 take 4 bytes for 0 voxels"},
    {"no runs along z", [](RawAtlas& a) { a.section(SectionKind::kRunsZ).kind = 77; },
     "F: invalid: runs of class 1 along axis 2 take 4 bytes for 0 voxels"},
    {"no runs along z and no lengths",
     [](RawAtlas& a) {
       a.section(SectionKind::kRunsZ).kind = 77;
       for (RawClass& c : a.directory.classes) c.run_bytes[2] = 0;
     },
     "F: invalid: section runs_z is missing"},
    {"no values", [](RawAtlas& a) { a.section(SectionKind::kValues).kind = 77; },
     "F: invalid: section values is missing"},
    {"no normals", [](RawAtlas& a) { a.section(SectionKind::kNormals).kind = 77; },
     "F: invalid: section normals is missing"},
    {"no surfaces", [](RawAtlas& a) { a.section(SectionKind::kSurfaces).kind = 0; },
     "F: invalid: section surfaces is missing"},
    {"values without a value type",
     [](RawAtlas& a) {
       a.directory.value_type = 0;
       const std::uint32_t chunks = std::exchange(a.section(SectionKind::kValues).chunks, 0u);
       a.directory.chunks.erase(a.directory.chunks.begin() + 3, a.directory.chunks.begin() + 3 + chunks);
       a.chunks.erase(a.chunks.begin() + 3, a.chunks.begin() + 3 + chunks);
     },
     "F: invalid: values without a value type"},
    {"runs along x twice", [](RawAtlas& a) { a.section(SectionKind::kRunsY).kind = 1; },
     "F: invalid: runs of class 1 along axis 1 take 4 bytes for 0 voxels"},
    {"runs along z twice", [](RawAtlas& a) { a.section(SectionKind::kValues).kind = 3; },
     "F: invalid: section runs_z occurs twice"},
    {"normals twice",
     [](RawAtlas& a) {
       a.directory.sections.push_back({5, 0, 262144, 512});
     },
     "F: invalid: section normals occurs twice"},
    {"an unknown section twice",
     [](RawAtlas& a) {
       a.directory.sections.push_back({77, 0, 0, 0});
       a.directory.sections.push_back({77, 0, 0, 0});
     },
     "F: invalid: section section 77 occurs twice"},
    {"no sections", [](RawAtlas& a) { a.directory.sections.clear(); },
     "F: invalid: runs of class 1 along axis 0 take 4 bytes for 0 voxels"},
    {"no sections and no chunks",
     [](RawAtlas& a) {
       a.directory.sections.clear();
       a.directory.chunks.clear();
       a.chunks.clear();
     },
     "F: invalid: runs of class 1 along axis 0 take 4 bytes for 0 voxels"},
    {"one chunk of runs along x too many", [](RawAtlas& a) { ++a.section(SectionKind::kRunsX).chunks; },
     "F: invalid: section runs_x has 2 chunks, its streams of 93 bytes need 1"},
    {"one chunk of values too few", [](RawAtlas& a) { --a.section(SectionKind::kValues).chunks; },
     "F: invalid: section values has 1 chunks, its streams of 680 bytes need more"},
    {"more chunks of surfaces than are left", [](RawAtlas& a) { ++a.section(SectionKind::kSurfaces).chunks; },
     "F: invalid: section surfaces has 2 chunks, 1 are left"},
    {"2^32 - 1 chunks", [](RawAtlas& a) { a.section(SectionKind::kSurfaces).chunks = 0xffffffff; },
     "F: invalid: section surfaces has 4294967295 chunks, 1 are left"},
    {"a chunk of no section",
     [](RawAtlas& a) {
       a.directory.chunks.push_back(a.directory.chunks.back());
       a.chunks.push_back(a.chunks.back());
     },
     "F: invalid: 1 chunks belong to no section"},
    {"no cut", [](RawAtlas& a) { a.section(SectionKind::kRunsX).chunk_bytes = 0; },
     "F: invalid: section runs_x is cut every 0 bytes, shared up to 512"},
    {"a cut below the minimum", [](RawAtlas& a) { a.section(SectionKind::kRunsY).chunk_bytes = 4088; },
     "F: invalid: section runs_y is cut every 4088 bytes, shared up to 512"},
    {"a cut above the maximum",
     [](RawAtlas& a) { a.section(SectionKind::kRunsZ).chunk_bytes = (1 << 24) + 8; },
     "F: invalid: section runs_z is cut every 16777224 bytes, shared up to 512"},
    {"the largest cut", [](RawAtlas& a) { a.section(SectionKind::kValues).chunk_bytes = 0xfffffff8; },
     "F: invalid: section values is cut every 4294967288 bytes, shared up to 512"},
    {"a cut across numbers", [](RawAtlas& a) { a.section(SectionKind::kNormals).chunk_bytes = 4100; },
     "F: invalid: section normals is cut every 4100 bytes, shared up to 512"},
    {"sharing above the cut", [](RawAtlas& a) { a.section(SectionKind::kSurfaces).shared_bytes = 262145; },
     "F: invalid: section surfaces is cut every 262144 bytes, shared up to 262145"},
    {"2^32 - 1 shared bytes", [](RawAtlas& a) { a.section(SectionKind::kNormals).shared_bytes = 0xffffffff; },
     "F: invalid: section normals is cut every 262144 bytes, shared up to 4294967295"},
    {"no sharing, but shared chunks", [](RawAtlas& a) { a.section(SectionKind::kRunsZ).shared_bytes = 0; },
     "F: invalid: section runs_z has 1 chunks, its streams of 120 bytes need more"},
};

constexpr BadFile kChunks[] = {
    {"of runs along x another checksum", [](RawAtlas& a) { ++a.chunk(SectionKind::kRunsX).checksum; },
     "F: damaged: checksum of runs_x of classes 1 to 7"},
    {"of runs along y another checksum", [](RawAtlas& a) { ++a.chunk(SectionKind::kRunsY).checksum; },
     "F: damaged: checksum of runs_y of classes 1 to 7"},
    {"of runs along z another checksum", [](RawAtlas& a) { ++a.chunk(SectionKind::kRunsZ).checksum; },
     "F: damaged: checksum of runs_z of classes 1 to 7"},
    {"of values another checksum", [](RawAtlas& a) { ++a.chunk(SectionKind::kValues).checksum; },
     "F: damaged: checksum of values of classes 0 to 4"},
    {"of normals another checksum", [](RawAtlas& a) { ++a.chunk(SectionKind::kNormals).checksum; },
     "F: damaged: checksum of normals of classes 2 to 4"},
    {"of surfaces another checksum", [](RawAtlas& a) { ++a.chunk(SectionKind::kSurfaces).checksum; },
     "F: damaged: checksum of surfaces of structures 'rim' to 'needle'"},
    {"of runs along x no bytes", [](RawAtlas& a) { a.chunk(SectionKind::kRunsX).stored_bytes = 0; },
     "F: invalid: chunk 0 of section runs_x stores 93 bytes as 0"},
    {"of runs along y more bytes than decoded",
     [](RawAtlas& a) { a.chunk(SectionKind::kRunsY).stored_bytes = 1000; },
     "F: invalid: chunk 0 of section runs_y stores 120 bytes as 1000"},
    {"of values 2^32 - 1 bytes", [](RawAtlas& a) { a.chunk(SectionKind::kValues).stored_bytes = 0xffffffff; },
     "F: invalid: chunk 0 of section values stores 487 bytes as 4294967295"},
    {"of normals one byte less", [](RawAtlas& a) { --a.chunk(SectionKind::kNormals).stored_bytes; },
     "F: invalid: chunks end at {2}, the file has {1} bytes"},
    {"of surfaces one byte less", [](RawAtlas& a) { --a.chunk(SectionKind::kSurfaces).stored_bytes; },
     "F: invalid: chunks end at {2}, the file has {1} bytes"},
    {"a byte moved to the next one",
     [](RawAtlas& a) {
       --a.chunk(SectionKind::kRunsX).stored_bytes;
       ++a.chunk(SectionKind::kRunsY).stored_bytes;
     },
     "F: damaged: checksum of runs_x of classes 1 to 7"},
    {"of runs along x codec 2", [](RawAtlas& a) { a.chunk(SectionKind::kRunsX).codec = 2; },
     "F: damaged: unknown codec 2 of runs_x of classes 1 to 7"},
    {"of values codec 255", [](RawAtlas& a) { a.chunk(SectionKind::kValues).codec = 255; },
     "F: damaged: unknown codec 255 of values of classes 0 to 4"},
    {"of runs along z filter 1", [](RawAtlas& a) { a.chunk(SectionKind::kRunsZ).filter = 1; },
     "F: damaged: unknown filter 1 of runs_z of classes 1 to 7"},
    {"of surfaces filter 255", [](RawAtlas& a) { a.chunk(SectionKind::kSurfaces).filter = 255; },
     "F: damaged: unknown filter 255 of surfaces of structures 'rim' to 'needle'"},
    {"of surfaces fewer bytes than decoded, and stored",
     [](RawAtlas& a) {
       a.set_chunk(SectionKind::kSurfaces, 0, Bytes(7));
       a.chunk(SectionKind::kSurfaces).codec = 0;
     },
     "F: damaged: 7 bytes, expected 180 of surfaces of structures 'rim' to 'needle'"},
    {"of normals said to be compressed", [](RawAtlas& a) { a.chunk(SectionKind::kNormals).codec ^= 1; },
     "F: damaged: not a Zstandard frame of normals of classes 2 to 4"},
    {"two exchanged", [](RawAtlas& a) { std::swap(a.chunks[0], a.chunks[1]); },
     "F: damaged: checksum of runs_x of classes 1 to 7"},
    {"two exchanged with their rows",
     [](RawAtlas& a) {
       std::swap(a.chunks[0], a.chunks[1]);
       std::swap(a.directory.chunks[0], a.directory.chunks[1]);
     },
     "F: damaged: wrong frame length (expected 93 bytes) of runs_x of classes 1 to 7"},
    {"one too few", [](RawAtlas& a) { a.chunks.pop_back(); },
     "F: invalid: chunks end at {0}, the file has {1} bytes"},
    {"none", [](RawAtlas& a) { a.chunks.clear(); }, "F: invalid: chunks end at {0}, the file has {1} bytes"},
    {"reserved bits, which are not read",
     [](RawAtlas& a) { a.chunk(SectionKind::kNormals).reserved = 0xffff; }, ""},
};

TEST(BadFiles, WithABadTableOfSurfaces) {
  expect_refused(kSurfaces);
}
TEST(BadFiles, WithABadScene) {
  expect_refused(kScenes);
}
TEST(BadFiles, WithABadSection) {
  expect_refused(kSections);
}
TEST(BadFiles, WithABadChunk) {
  expect_refused(kChunks);
}

}  // namespace
}  // namespace splatlas
