// Invalid files: tables of surfaces, scenes, sections and chunks.
#include <limits>
#include <utility>

#include <gtest/gtest.h>

#include "format/atlas_reader.h"
#include "tests/format/bad_files/bad_files.h"

namespace splatlas {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

using enum good::Structure;
using enum SectionKind;
using BadDirectory = BadFile<RawDirectory>;

constexpr BadDirectory kSurfaceCounts[] = {
    {"one too few", [](auto& d) { d.surfaces.pop_back(); }, "4"},
    {"one too many",
     [](auto& d) {
       d.surfaces.push_back(RawSurface{0, 0, 2, 0});
     },
     "6"},
    {"none", [](auto& d) { d.surfaces.clear(); }, "0"},
};

/// The surface of a structure.
struct BadSurface {
  good::Structure structure;
  void (*change)(RawSurface& surface);
  const char* message = "";
};

constexpr BadSurface kSurfaceRows[] = {
    {kAll, [](auto& s) { s.triangles = 1; }, "'all': no vertices, 1 triangles, 0 bytes"},
    {kAll, [](auto& s) { s.bytes = 8; }, "'all': no vertices, 0 triangles, 8 bytes"},
    {kRim, [](auto& s) { s.position_scale = 0; }, "'rim': position scale 0"},
    {kRim, [](auto& s) { s.position_scale = 0xffffffff; }, "'rim': position scale 4294967295"},
    {kCore, [](auto& s) { s.position_scale = 3; }, "'core': fitted, with position scale 3 and 104 triangles"},
    {kCore, [](auto& s) { s.position_scale = 257; },
     "'core': fitted, with position scale 257 and 104 triangles"},
    {kCore, [](auto& s) { s.triangles = 0; }, "'core': fitted, with position scale 256 and 0 triangles"},
    {kCore, [](auto& s) { ++s.vertices; },
     "'core': 55 vertices and 104 triangles, its voxels give 54 and 104"},
    {kKnob, [](auto& s) { s.vertices = s.triangles = 0xffffffff; },
     "'knob': 4294967295 vertices and 4294967295 triangles for 27 voxels"},
    {kKnob, [](auto& s) { s.vertices = 6 * 27 + 1; }, "'knob': 163 vertices and 104 triangles for 27 voxels"},
    {kRim, [](auto& s) { s.triangles = 1000; }, "'rim': 86 bytes for 4 vertices and 1000 triangles"},
    {kRim, [](auto& s) { --s.vertices; }, "'rim': triangle 1 has vertex 3 of 3"},
    {kRim, [](auto& s) { ++s.triangles; }, "'rim': triangles cannot be decoded"},
    {kRim, [](auto& s) { s.position_scale = 8192; }, "'rim': vertices cannot be decoded"},
};

constexpr BadDirectory kOtherSurfaces[] = {
    {"fitted where they are stored", [](auto& d) { d.surfaces[kRim].bytes = d.surfaces[kNeedle].bytes = 0; },
     "invalid: surface of structure 'rim': fitted, with position scale 2 and 2 triangles"},
    {"one byte more", [](auto& d) { ++d.surfaces[kRim].bytes; },
     "damaged: wrong frame length (expected 181 bytes) of surfaces of structures 'rim' to 'needle'"},
};

constexpr BadSurface kValidSurfaces[] = {
    {kRim, [](auto& s) { ++s.vertices; }},
};

constexpr BadPart<RawScene> kScenes[] = {
    {[](auto& s) { s.azimuth_deg = kNan; }, "nan, elevation 20, zoom 1.5"},
    {[](auto& s) { s.elevation_deg = -kInf; }, "30, elevation -inf, zoom 1.5"},
    {[](auto& s) { s.zoom = 0; }, "30, elevation 20, zoom 0"},
    {[](auto& s) { s.zoom = kInf; }, "30, elevation 20, zoom inf"},
};

/// The row of a section, or of its first chunk.
template <typename Row>
struct BadRow {
  SectionKind kind;
  void (*change)(Row& row);
  const char* message = "";
};

constexpr BadRow<RawSection> kSections[] = {
    {kRunsX, [](auto& s) { s.kind = 77; }, "runs of class 1 along axis 0 take 4 bytes for 0 voxels"},
    {kRunsZ, [](auto& s) { s.kind = 77; }, "runs of class 1 along axis 2 take 4 bytes for 0 voxels"},
    {kValues, [](auto& s) { s.kind = 77; }, "section values is missing"},
    {kNormals, [](auto& s) { s.kind = 77; }, "section normals is missing"},
    {kSurfaces, [](auto& s) { s.kind = 0; }, "section surfaces is missing"},
    {kValues, [](auto& s) { s.kind = 3; }, "section runs_z occurs twice"},
    {kRunsX, [](auto& s) { ++s.chunks; }, "section runs_x has 2 chunks, its streams of 93 bytes need 1"},
    {kValues, [](auto& s) { --s.chunks; }, "section values has 1 chunks, its streams of 680 bytes need more"},
    {kSurfaces, [](auto& s) { ++s.chunks; }, "section surfaces has 2 chunks, 1 are left"},
    {kRunsZ, [](auto& s) { s.shared_bytes = 0; },
     "section runs_z has 1 chunks, its streams of 120 bytes need more"},
};

constexpr BadRow<RawSection> kCuts[] = {
    {kRunsX, [](auto& s) { s.chunk_bytes = 0; }, "runs_x is cut every 0 bytes, shared up to 512"},
    {kRunsY, [](auto& s) { s.chunk_bytes = 4088; }, "runs_y is cut every 4088 bytes, shared up to 512"},
    {kRunsZ, [](auto& s) { s.chunk_bytes = (1 << 24) + 8; },
     "runs_z is cut every 16777224 bytes, shared up to 512"},
    {kNormals, [](auto& s) { s.chunk_bytes = 4100; }, "normals is cut every 4100 bytes, shared up to 512"},
    {kSurfaces, [](auto& s) { s.shared_bytes = 262145; },
     "surfaces is cut every 262144 bytes, shared up to 262145"},
};

constexpr BadFile<RawAtlas> kSectionTables[] = {
    {"no runs along z and no lengths",
     [](auto& a) {
       a.section(kRunsZ).kind = 77;
       for (RawClass& c : a.directory.classes) c.run_bytes[2] = 0;
     },
     "section runs_z is missing"},
    {"values without a value type",
     [](auto& a) {
       a.directory.value_type = 0;
       const std::uint32_t chunks = std::exchange(a.section(kValues).chunks, 0u);
       a.directory.chunks.erase(a.directory.chunks.begin() + 3, a.directory.chunks.begin() + 3 + chunks);
       a.chunks.erase(a.chunks.begin() + 3, a.chunks.begin() + 3 + chunks);
     },
     "values without a value type"},
    {"normals twice",
     [](auto& a) {
       a.directory.sections.push_back(RawSection{5, 0, 262144, 512});
     },
     "section normals occurs twice"},
    {"an unknown section twice",
     [](auto& a) {
       a.directory.sections.resize(a.directory.sections.size() + 2, RawSection{77, 0, 0, 0});
     },
     "section section 77 occurs twice"},
    {"no sections", [](auto& a) { a.directory.sections.clear(); },
     "runs of class 1 along axis 0 take 4 bytes for 0 voxels"},
    {"a chunk of no section",
     [](auto& a) {
       a.directory.chunks.push_back(a.directory.chunks.back());
       a.chunks.push_back(a.chunks.back());
     },
     "1 chunks belong to no section"},
};

constexpr BadRow<RawChunk> kInvalidChunks[] = {
    {kRunsX, [](auto& c) { c.stored_bytes = 0; }, "chunk 0 of section runs_x stores 93 bytes as 0"},
    {kRunsY, [](auto& c) { c.stored_bytes = 1000; }, "chunk 0 of section runs_y stores 120 bytes as 1000"},
    {kNormals, [](auto& c) { --c.stored_bytes; }, "chunks end at {2}, the file has {1} bytes"},
};

constexpr BadRow<RawChunk> kDamagedChunks[] = {
    {kRunsX, [](auto& c) { ++c.checksum; }, "checksum of runs_x of classes 1 to 7"},
    {kRunsY, [](auto& c) { ++c.checksum; }, "checksum of runs_y of classes 1 to 7"},
    {kRunsZ, [](auto& c) { ++c.checksum; }, "checksum of runs_z of classes 1 to 7"},
    {kValues, [](auto& c) { ++c.checksum; }, "checksum of values of classes 0 to 4"},
    {kNormals, [](auto& c) { ++c.checksum; }, "checksum of normals of classes 2 to 4"},
    {kSurfaces, [](auto& c) { ++c.checksum; }, "checksum of surfaces of structures 'rim' to 'needle'"},
    {kRunsX, [](auto& c) { c.codec = 2; }, "unknown codec 2 of runs_x of classes 1 to 7"},
    {kRunsZ, [](auto& c) { c.filter = 1; }, "unknown filter 1 of runs_z of classes 1 to 7"},
    {kNormals, [](auto& c) { c.codec ^= 1; }, "not a Zstandard frame of normals of classes 2 to 4"},
};

constexpr BadFile<RawAtlas> kChunkTables[] = {
    {"a byte moved to the next one",
     [](auto& a) {
       --a.chunk(kRunsX).stored_bytes;
       ++a.chunk(kRunsY).stored_bytes;
     },
     "damaged: checksum of runs_x of classes 1 to 7"},
    {"of surfaces fewer bytes than decoded, and stored",
     [](auto& a) {
       a.set_chunk(kSurfaces, 0, Bytes(7));
       a.chunk(kSurfaces).codec = 0;
     },
     "damaged: 7 bytes, expected 180 of surfaces of structures 'rim' to 'needle'"},
    {"two exchanged with their rows",
     [](auto& a) {
       std::swap(a.chunks[0], a.chunks[1]);
       std::swap(a.directory.chunks[0], a.directory.chunks[1]);
     },
     "damaged: wrong frame length (expected 93 bytes) of runs_x of classes 1 to 7"},
    {"one too few", [](auto& a) { a.chunks.pop_back(); },
     "invalid: chunks end at {0}, the file has {1} bytes"},
};

constexpr BadRow<RawChunk> kValidChunks[] = {
    {kNormals, [](auto& c) { c.reserved = 0xffff; }},
};

TEST(BadFiles, WithABadTableOfSurfaces) {
  const auto in_surface = [](RawAtlas& a, const BadSurface& row) {
    row.change(a.directory.surfaces[row.structure]);
  };
  expect_faults(kSurfaceCounts, "F: invalid: {} surfaces of 5 structures", in_directory);
  expect_faults(kSurfaceRows, "F: invalid: surface of structure {}", in_surface);
  expect_faults(kOtherSurfaces, "F: {}", in_directory);
  expect_faults(kValidSurfaces, "", in_surface);
}

/// Of the five structures, the first has one term: "v" and "code".
void add_terms(RawDirectory& d) {
  d.terms_end = {1, 1, 1, 1, 1};
  d.term_text_ends = {1, 5};
  for (const char c : std::string("vcode")) d.term_text.push_back(static_cast<std::uint8_t>(c));
}

constexpr BadDirectory kTerms[] = {
    {"one end too few", [](auto& d) { add_terms(d), d.terms_end.pop_back(); }},
    {"falling ends",
     [](auto& d) {
       add_terms(d), d.terms_end = {1, 0, 1, 1, 1};
     }},
    {"more terms than strings", [](auto& d) { add_terms(d), d.terms_end.back() = 2; }},
    {"an odd number of strings",
     [](auto& d) {
       add_terms(d), d.term_text_ends = {1, 4, 5};
     }},
    {"strings beyond the text", [](auto& d) { add_terms(d), d.term_text_ends.back() = 6; }},
    {"text beyond the strings", [](auto& d) { add_terms(d), d.term_text.push_back('x'); }},
};

constexpr BadDirectory kTermTexts[] = {
    {"a control character", [](auto& d) { add_terms(d), d.term_text[2] = 7; },
     "has a control character (byte 1: U+0007)"},
    {"bytes that are no UTF-8", [](auto& d) { add_terms(d), d.term_text[0] = 0xff; },
     "is not UTF-8 (byte 0)"},
};

TEST(BadFiles, WithBadTerms) {
  RawAtlas atlas = raw_atlas(good_file());
  add_terms(atlas.directory);
  const auto good = value_or_throw(Atlas::open_bytes(file_of(atlas)));
  EXPECT_EQ(good->graph()[0].terms, (std::vector<Term>{{"v", "code"}}));
  EXPECT_TRUE(good->graph()[1].terms.empty());
  expect_faults(kTerms, "F: invalid: inconsistent offsets of directory tables of terms", in_directory);
  expect_faults(kTermTexts, "F: invalid: term of structure 0 {}", in_directory);
}

/// The scene has a question, "why", and a cut, "left=1".
void add_scene_text(RawDirectory& d) {
  d.scene_text_ends = {3, 9, 9};
  for (const char c : std::string("whyleft=1")) d.scene_text.push_back(static_cast<std::uint8_t>(c));
}

/// The scene has a projection, "perspective", and the labels "a" and "b".
void add_scene_views(RawDirectory& d) {
  d.scene_view_ends = {11, 14};
  for (const char c : std::string("perspectivea\nb"))
    d.scene_view_text.push_back(static_cast<std::uint8_t>(c));
}

constexpr BadDirectory kSceneOffsets[] = {
    {"a view without ends", [](auto& d) { add_scene_views(d), d.scene_view_ends.clear(); }},
    {"three ends of a view", [](auto& d) { add_scene_views(d), d.scene_view_ends.push_back(14); }},
    {"one end too few", [](auto& d) { add_scene_text(d), d.scene_text_ends.pop_back(); }},
    {"falling ends",
     [](auto& d) {
       add_scene_text(d), d.scene_text_ends = {9, 3, 9};
     }},
    {"a string beyond the text", [](auto& d) { add_scene_text(d), d.scene_text_ends.back() = 10; }},
    {"text beyond the strings", [](auto& d) { add_scene_text(d), d.scene_text.push_back('x'); }},
};

constexpr BadDirectory kSceneTexts[] = {
    {"a control character in a label", [](auto& d) { add_scene_views(d), d.scene_view_text[13] = 7; },
     "has a control character (byte 0: U+0007)"},
    {"a control character", [](auto& d) { add_scene_text(d), d.scene_text[2] = 7; },
     "has a control character (byte 2: U+0007)"},
    {"bytes that are no UTF-8", [](auto& d) { add_scene_text(d), d.scene_text[3] = 0xff; },
     "is not UTF-8 (byte 0)"},
};

TEST(BadFiles, WithBadTextsOfScenes) {
  RawAtlas atlas = raw_atlas(good_file());
  add_scene_text(atlas.directory);
  add_scene_views(atlas.directory);
  const auto good = value_or_throw(Atlas::open_bytes(file_of(atlas)));
  const Scene& scene = good->scenes().front();
  EXPECT_EQ((std::array{scene.name, scene.question, scene.cuts, scene.center}),
            (std::array<std::string, 4>{"First", "why", "left=1", ""}));
  EXPECT_TRUE(scene.perspective);
  EXPECT_EQ(scene.labels, (std::vector<std::string>{"a", "b"}));
  expect_faults(kSceneOffsets, "F: invalid: inconsistent offsets of directory text of scenes", in_directory);
  expect_faults(kSceneTexts, "F: invalid: text of scene 0 {}", in_directory);
}

TEST(BadFiles, WithABadScene) {
  expect_faults(kScenes, "F: invalid: camera of scene 0: azimuth {}",
                in_part([](auto& d) -> RawScene& { return d.scenes[0]; }));
}

TEST(BadFiles, WithABadSection) {
  const auto in_section = [](RawAtlas& a, const auto& row) { row.change(a.section(row.kind)); };
  expect_faults(kSections, "F: invalid: {}", in_section);
  expect_faults(kCuts, "F: invalid: section {}", in_section);
  expect_faults(kSectionTables, "F: invalid: {}", in_atlas);
}

TEST(BadFiles, WithABadChunk) {
  const auto in_chunk = [](RawAtlas& a, const auto& row) { row.change(a.chunk(row.kind)); };
  expect_faults(kInvalidChunks, "F: invalid: {}", in_chunk);
  expect_faults(kDamagedChunks, "F: damaged: {}", in_chunk);
  expect_faults(kChunkTables, "F: {}", in_atlas);
  expect_faults(kValidChunks, "", in_chunk);
}

}  // namespace
}  // namespace splatlas
