#include "format/file/directory.h"

#include <functional>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "format/atlas_writer.h"
#include "tests/format/atlas_surgery.h"
#include "tests/format/random_content.h"

namespace splatlas {
namespace {

using ::testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Three structures in 4 x 3 x 2 voxels: a box with a boundary, a second that overlaps it, a group.
AtlasContent small_content() {
  AtlasContent content;
  content.source_grid.size = {4, 3, 2};
  std::vector<Structure> structures(3);
  structures[0] = {"all", "All", {}, {}, {}, false};
  structures[1] = {"a", "A", {1, 2, 3}, 7, {0}, false};
  structures[2] = {"b", "B", {}, {}, {0, 1}, false};
  content.graph = *StructureGraph::build(structures);
  const ClassId a = content.classes.intern({{1, Part::kBoundary}});
  const ClassId ab = content.classes.intern({{1, Part::kBoundary}, {2, Part::kBoundary}});
  content.class_volume = {0, a, a, 0, 0, a, ab, 0, 0, 0, 0, 0, 0, a, a, 0, 0, a, ab, 0, 0, 0, 0, 0};
  content.classes.count(0, 16, {{0, 0, 0}, {3, 2, 1}});
  content.classes.count(a, 6, {{1, 0, 0}, {2, 1, 1}});
  content.classes.count(ab, 2, {{2, 1, 0}, {2, 1, 1}});
  content.values = {VoxelType::kUInt8, std::vector<std::byte>(24)};
  content.surfaces.resize(3);
  content.surfaces[1].positions_ijk = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  content.surfaces[1].normals_lps.assign(3, {0, 0, 1});
  content.surfaces[1].triangles = {{0, 1, 2}};
  content.boundary_normals = {{}, std::vector<PackedNormal>(6), std::vector<PackedNormal>(2)};
  content.scenes = {{"s", "c", "a:both", 1, 2, 3}};
  return content;
}

Directory small_directory() {
  return take_apart(encode_atlas(small_content()).value()).directory;
}

std::string fault_after(const std::function<void(Directory&)>& change) {
  Directory directory = small_directory();
  change(directory);
  const auto valid = validate(directory);
  if (valid) return "";
  EXPECT_EQ(valid.error().code, ErrorCode::kInvalidAtlas);
  return valid.error().message;
}

TEST(Directory, IsValidAsWritten) {
  EXPECT_EQ(fault_after([](Directory&) {}), "");
}

TEST(Directory, RefusesImpossibleGeometry) {
  EXPECT_THAT(fault_after([](Directory& d) { d.source_grid.size[1] = 0; }), HasSubstr("source grid"));
  EXPECT_THAT(fault_after([](Directory& d) { d.source_grid.size[1] = -3; }), HasSubstr("source grid"));
  EXPECT_THAT(fault_after([](Directory& d) {
                d.source_grid.size = {1 << 20, 1 << 20, 1 << 20};
              }),
              HasSubstr("source grid"));
  EXPECT_THAT(fault_after([](Directory& d) { d.source_grid.spacing_mm[0] = kNan; }),
              HasSubstr("source grid"));
  EXPECT_THAT(fault_after([](Directory& d) { d.source_grid.direction_lps = {}; }), HasSubstr("source grid"));
  EXPECT_THAT(fault_after([](Directory& d) {
                d.source_to_storage.from = {0, 1, 1};
              }),
              HasSubstr("permutation"));
  EXPECT_THAT(fault_after([](Directory& d) {
                d.source_to_storage.from = {0, 1, 3};
              }),
              HasSubstr("permutation"));
  EXPECT_THAT(fault_after([](Directory& d) { d.value_type = static_cast<VoxelType>(9); }),
              HasSubstr("unknown voxel type 9"));
  EXPECT_THAT(fault_after([](Directory& d) { d.label_type = static_cast<VoxelType>(200); }),
              HasSubstr("unknown voxel type 200"));
  EXPECT_THAT(fault_after([](Directory& d) { d.display.window_high = kNan; }), HasSubstr("display"));
  EXPECT_THAT(fault_after([](Directory& d) { d.display.center_lps_mm[2] = kNan; }), HasSubstr("display"));
  EXPECT_THAT(fault_after([](Directory& d) { d.display.center_lps_mm[0] = -2e15; }), HasSubstr("display"));
  EXPECT_THAT(fault_after([](Directory& d) { d.display.radius_mm = 2e15; }), HasSubstr("display"));
  EXPECT_THAT(fault_after([](Directory& d) { d.display.radius_mm = -1; }), HasSubstr("display"));
}

TEST(Directory, RefusesClassesThatDoNotPartitionTheGrid) {
  EXPECT_THAT(fault_after([](Directory& d) {
                d.source_grid.size = {4, 3, 3};
              }),
              HasSubstr("classes have 24 voxels, the grid has 36"));
  EXPECT_THAT(fault_after([](Directory& d) { d.classes.count(2, 1, {}); }),
              HasSubstr("more voxels than the grid's 24"));
  EXPECT_THAT(fault_after([](Directory& d) {
                d.classes.count(1, 0, {{0, 0, 0}, {4, 0, 0}});
              }),
              HasSubstr("box of class 1"));
  EXPECT_THAT(fault_after([](Directory& d) {
                d.classes.count(1, 0, {{0, 0, -1}, {0, 0, 0}});
              }),
              HasSubstr("box of class 1"));
  EXPECT_THAT(fault_after([](Directory& d) {
                d.classes = {};
                d.classes.intern({{1, Part::kBoundary}});
                d.classes.intern({{2, Part::kBoundary}});
                d.classes.count(0, 20, {});
                d.classes.count(1, 4, {{0, 0, 0}, {2, 0, 0}});  // four voxels in three
              }),
              HasSubstr("box of class 1 does not fit its 4 voxels"));
  EXPECT_THAT(fault_after([](Directory& d) {
                d.classes = {};
                d.classes.intern({{1, Part::kBoundary}});
                d.classes.intern({{2, Part::kBoundary}});
                d.classes.count(0, 20, {});
                d.classes.count(1, 4, {});  // voxels, but no box
              }),
              HasSubstr("box of class 1"));
}

TEST(Directory, RefusesRunListsOfImpossibleLength) {
  EXPECT_THAT(fault_after([](Directory& d) { d.run_bytes[0][2] = 4; }),
              HasSubstr("runs of class 0 along axis 2"));
  EXPECT_THAT(fault_after([](Directory& d) { d.run_bytes[1][0] = 3; }),
              HasSubstr("take 3 bytes for 6 voxels"));
  EXPECT_THAT(fault_after([](Directory& d) { d.run_bytes[1][1] = 131; }),
              HasSubstr("take 131 bytes for 6 voxels"));
  EXPECT_THAT(fault_after([](Directory& d) { d.run_totals[2] = 9; }), HasSubstr("9 runs of 8 voxels"));
  EXPECT_THAT(fault_after([](Directory& d) { d.sections.erase(d.sections.begin()); }),
              HasSubstr("runs of class 1 along axis 0"));
}

TEST(Directory, RefusesSurfacesOfImpossibleSize) {
  EXPECT_THAT(fault_after([](Directory& d) { d.surfaces.pop_back(); }),
              HasSubstr("2 surfaces of 3 structures"));
  EXPECT_THAT(fault_after([](Directory& d) { d.surfaces[1].triangles = 100'000; }),
              HasSubstr("surface of structure 'a'"));
}

TEST(Directory, RefusesTextThatCannotBeShown) {
  const auto title = [](std::string text) {
    return fault_after([&](Directory& d) { d.provenance.title = std::move(text); });
  };
  for (const char* good : {"", "a\n\tb", "Größe", "脳", "\xf0\x9f\xa7\xa0", "\xed\x9f\xbf", "\xee\x80\x80",
                           "\xf4\x8f\xbf\xbf"}) {
    EXPECT_EQ(title(good), "") << good;
  }
  // Lone and missing continuations, overlong forms, surrogates, beyond U+10FFFF, bytes that never occur.
  for (const char* bad :
       {"\x80", "a\xc3", "\xc3(", "\xc0\xaf", "\xc1\xbf", "\xe0\x9f\xbf", "\xed\xa0\x80", "\xf0\x8f\xbf\xbf",
        "\xf4\x90\x80\x80", "\xf5\x80\x80\x80", "\xff", "\xe2\x82", "\xf0\x9f\xa7"}) {
    EXPECT_THAT(title(bad), HasSubstr("not UTF-8"));
  }
  EXPECT_THAT(title(std::string(1, '\0')), HasSubstr("control character"));
  EXPECT_THAT(title("\x1b[31m"), HasSubstr("control character (byte 0: U+001B)"));
  EXPECT_THAT(title("a\x7f"), HasSubstr("control character"));
  EXPECT_THAT(fault_after([](Directory& d) { d.scenes[0].caption = std::string("\xff"); }),
              HasSubstr("scene 0"));
  EXPECT_THAT(fault_after([](Directory& d) { d.provenance.sources = {{"\xff", ""}}; }), HasSubstr("role"));
  EXPECT_THAT(fault_after([](Directory& d) { d.provenance.sources = {{"", "\xff"}}; }), HasSubstr("hash"));
}

TEST(Directory, RefusesScenesWithoutACamera) {
  EXPECT_THAT(fault_after([](Directory& d) { d.scenes[0].azimuth_deg = kNan; }),
              HasSubstr("camera of scene 0"));
  EXPECT_THAT(fault_after([](Directory& d) { d.scenes[0].zoom = 0; }), HasSubstr("camera of scene 0"));
}

TEST(Directory, RefusesSectionsThatDoNotHoldTheStreams) {
  const auto fault = [](const std::function<void(Directory&)>& change) {
    Directory directory = small_directory();
    change(directory);
    const auto layout = lay_out(directory, 1000);
    return layout ? std::string() : layout.error().message;
  };
  EXPECT_EQ(fault([](Directory&) {}), "");
  EXPECT_THAT(fault([](Directory& d) { d.sections[3].kind = 3; }), HasSubstr("runs_z occurs twice"));
  EXPECT_THAT(fault([](Directory& d) { d.sections[2].kind = 77; }), HasSubstr("section runs_z is missing"));
  EXPECT_THAT(fault([](Directory& d) { d.sections[3].kind = 77; }), HasSubstr("section values is missing"));
  EXPECT_THAT(fault([](Directory& d) { d.value_type = VoxelType::kNone; }),
              HasSubstr("section values has 1 chunks"));
  EXPECT_THAT(fault([](Directory& d) { d.value_type = VoxelType::kFloat64; }), HasSubstr(""));
  EXPECT_THAT(fault([](Directory& d) { d.sections[0].chunks = 2; }),
              HasSubstr("section runs_x has 2 chunks"));
  EXPECT_THAT(fault([](Directory& d) { d.sections[5].chunks = 100; }), HasSubstr("100 chunks, 1 are left"));
  EXPECT_THAT(fault([](Directory& d) { d.chunks.push_back({}); }),
              HasSubstr("1 chunks belong to no section"));
  EXPECT_THAT(fault([](Directory& d) { d.sections[0].chunk_bytes = 8; }), HasSubstr("cut every 8 bytes"));
  EXPECT_THAT(fault([](Directory& d) { d.sections[0].chunk_bytes = 1u << 25; }), HasSubstr("cut every"));
  EXPECT_THAT(fault([](Directory& d) { d.sections[0].chunk_bytes = 4100; }), HasSubstr("cut every"));
  EXPECT_THAT(fault([](Directory& d) { d.sections[0].shared_bytes = 1u << 19; }),
              HasSubstr("shared up to 524288"));
  EXPECT_THAT(fault([](Directory& d) { d.chunks[0].stored_bytes = 0; }),
              HasSubstr("chunk 0 of section runs_x"));
  EXPECT_THAT(fault([](Directory& d) { d.chunks[3].stored_bytes = 1000; }), HasSubstr("bytes as 1000"));
}

RC_GTEST_PROP(Directory, DecodesWhatWasEncoded, ()) {
  auto random = *random_source();
  WriteOptions options;
  options.level = 1;
  const AtlasContent content = random_content(random);
  const Directory directory = take_apart(encode_atlas(content, options).value()).directory;
  const auto bytes = encode_directory(directory).value();
  RC_ASSERT(encode_directory(decode_directory(bytes).value()).value() == bytes);
  RC_ASSERT(std::ranges::equal(directory.graph.structures(), content.graph.structures()));
  RC_ASSERT(same_classes(directory.classes, content.classes));
  RC_ASSERT(directory.scenes == content.scenes);
  RC_ASSERT(directory.provenance == content.provenance);
}

TEST(Directory, RefusesBytesThatAreNone) {
  EXPECT_THAT(decode_directory({}).error().message, HasSubstr("directory of 0 bytes"));
  EXPECT_THAT(decode_directory(Bytes(100)).error().message, HasSubstr("not a FlatBuffer"));
  const Bytes good = encode_directory(small_directory()).value();
  for (std::size_t length = 0; length < good.size(); length += 4) {
    const Bytes prefix(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(length));
    EXPECT_FALSE(decode_directory(prefix)) << length;
  }
}

}  // namespace
}  // namespace splatlas
