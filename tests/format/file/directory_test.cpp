#include "format/file/directory.h"

#include <functional>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "format/atlas_writer.h"
#include "tests/format/atlas_surgery.h"
#include "tests/format/random_content.h"
#include "tests/support/message_of.h"

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

/// A change of the small directory, and a part of the message.
struct Fault {
  void (*change)(Directory& directory);
  const char* part;
};

std::string fault_after(const std::function<void(Directory&)>& change) {
  Directory directory = small_directory();
  change(directory);
  const auto valid = validate(directory);
  if (valid) return "";
  EXPECT_EQ(valid.error().code, ErrorCode::kInvalidAtlas);
  return valid.error().message;
}

void expect_refused(std::initializer_list<Fault> faults) {
  for (const auto& [change, part] : faults) EXPECT_THAT(fault_after(change), HasSubstr(part));
}

TEST(Directory, IsValidAsWritten) {
  EXPECT_EQ(fault_after([](Directory&) {}), "");
}

TEST(Directory, RefusesImpossibleGeometry) {
  expect_refused({
      {[](auto& d) { d.source_grid.size[1] = 0; }, "source grid"},
      {[](auto& d) { d.source_grid.size[1] = -3; }, "source grid"},
      {[](auto& d) { d.source_grid.size.fill(1 << 20); }, "source grid"},
      {[](auto& d) { d.source_grid.spacing_mm[0] = kNan; }, "source grid"},
      {[](auto& d) { d.source_grid.direction_lps = {}; }, "source grid"},
      {[](auto& d) { d.source_to_storage.from[2] = 1; }, "permutation"},
      {[](auto& d) { d.source_to_storage.from[2] = 3; }, "permutation"},
      {[](auto& d) { d.value_type = static_cast<VoxelType>(9); }, "unknown voxel type 9"},
      {[](auto& d) { d.label_type = static_cast<VoxelType>(200); }, "unknown voxel type 200"},
      {[](auto& d) { d.display.window_high = kNan; }, "display"},
      {[](auto& d) { d.display.center_lps_mm[2] = kNan; }, "display"},
      {[](auto& d) { d.display.center_lps_mm[0] = -2e15; }, "display"},
      {[](auto& d) { d.display.radius_mm = 2e15; }, "display"},
      {[](auto& d) { d.display.radius_mm = -1; }, "display"},
  });
}

/// Classes of 20 voxels and of four in this box.
ClassTable four_voxels_in(const IndexBox& box) {
  ClassTable classes;
  classes.intern({{1, Part::kBoundary}});
  classes.intern({{2, Part::kBoundary}});
  classes.count(0, 20, {});
  classes.count(1, 4, box);
  return classes;
}

TEST(Directory, RefusesClassesThatDoNotPartitionTheGrid) {
  expect_refused({
      {[](auto& d) { d.source_grid.size[2] = 3; }, "classes have 24 voxels, the grid has 36"},
      {[](auto& d) { d.classes.count(2, 1, {}); }, "more voxels than the grid's 24"},
      {[](auto& d) {
         d.classes.count(1, 0, IndexBox{{0, 0, 0}, {4, 0, 0}});
       },
       "box of class 1"},
      {[](auto& d) {
         d.classes.count(1, 0, IndexBox{{0, 0, -1}, {0, 0, 0}});
       },
       "box of class 1"},
      {[](auto& d) {
         d.classes = four_voxels_in({{0, 0, 0}, {2, 0, 0}});
       },
       "box of class 1 does not fit its 4 voxels"},
      {[](auto& d) { d.classes = four_voxels_in({}); }, "box of class 1"},
  });
}

TEST(Directory, RefusesRunListsOfImpossibleLength) {
  expect_refused({
      {[](auto& d) { d.run_bytes[0][2] = 4; }, "runs of class 0 along axis 2"},
      {[](auto& d) { d.run_bytes[1][0] = 3; }, "take 3 bytes for 6 voxels"},
      {[](auto& d) { d.run_bytes[1][1] = 131; }, "take 131 bytes for 6 voxels"},
      {[](auto& d) { d.run_totals[2] = 9; }, "9 runs of 8 voxels"},
      {[](auto& d) { d.sections.erase(d.sections.begin()); }, "runs of class 1 along axis 0"},
  });
}

TEST(Directory, RefusesSurfacesOfImpossibleSize) {
  expect_refused({
      {[](auto& d) { d.surfaces.pop_back(); }, "2 surfaces of 3 structures"},
      {[](auto& d) { d.surfaces[1].triangles = 100'000; }, "surface of structure 'a'"},
  });
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
  expect_refused({
      {[](auto& d) { d.scenes[0].caption = "\xff"; }, "scene 0"},
      {[](auto& d) {
         d.provenance.sources.assign(1, Source{"\xff", ""});
       },
       "role"},
      {[](auto& d) {
         d.provenance.sources.assign(1, Source{"", "\xff"});
       },
       "hash"},
  });
}

TEST(Directory, RefusesScenesWithoutACamera) {
  expect_refused({
      {[](auto& d) { d.scenes[0].azimuth_deg = kNan; }, "camera of scene 0"},
      {[](auto& d) { d.scenes[0].zoom = 0; }, "camera of scene 0"},
  });
}

TEST(Directory, RefusesSectionsThatDoNotHoldTheStreams) {
  ASSERT_TRUE(lay_out(small_directory(), 1000));
  for (const auto& [change, part] : std::initializer_list<Fault>{
           {[](auto& d) { d.sections[3].kind = 3; }, "runs_z occurs twice"},
           {[](auto& d) { d.sections[2].kind = 77; }, "section runs_z is missing"},
           {[](auto& d) { d.sections[3].kind = 77; }, "section values is missing"},
           {[](auto& d) { d.value_type = VoxelType::kNone; }, "section values has 1 chunks"},
           {[](auto& d) { d.value_type = VoxelType::kFloat64; }, ""},
           {[](auto& d) { d.sections[0].chunks = 2; }, "section runs_x has 2 chunks"},
           {[](auto& d) { d.sections[5].chunks = 100; }, "100 chunks, 1 are left"},
           {[](auto& d) { d.chunks.push_back({}); }, "1 chunks belong to no section"},
           {[](auto& d) { d.sections[0].chunk_bytes = 8; }, "cut every 8 bytes"},
           {[](auto& d) { d.sections[0].chunk_bytes = 1u << 25; }, "cut every"},
           {[](auto& d) { d.sections[0].chunk_bytes = 4100; }, "cut every"},
           {[](auto& d) { d.sections[0].shared_bytes = 1u << 19; }, "shared up to 524288"},
           {[](auto& d) { d.chunks[0].stored_bytes = 0; }, "chunk 0 of section runs_x"},
           {[](auto& d) { d.chunks[3].stored_bytes = 1000; }, "bytes as 1000"}}) {
    Directory directory = small_directory();
    change(directory);
    EXPECT_THAT(message_of(lay_out(directory, 1000)), HasSubstr(part));
  }
}

RC_GTEST_PROP(Directory, DecodesWhatWasEncoded, ()) {
  auto random = *random_source();
  const AtlasContent content = random_content(random);
  const Directory directory = take_apart(encode_atlas(content, {.level = 1}).value()).directory;
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
    EXPECT_FALSE(decode_directory(slice(good, 0, length))) << length;
  }
}

}  // namespace
}  // namespace splatlas
