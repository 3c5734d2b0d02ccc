#include "format/atlas_writer.h"

#include <limits>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "format/atlas_reader.h"
#include "tests/format/random_content.h"
#include "tests/support/fails_with.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

/// An atlas with several chunks in most sections.
const AtlasContent& large_content() {
  const auto wanted = [](const AtlasContent& content) {
    const std::size_t values = content.values.bytes.size();
    return content.graph.size() > 5 && values > 500'000 && values < 1'000'000;
  };
  static const AtlasContent found = random_content_with(wanted, 3, {80, 8, 10'000});
  return found;
}

TEST(AtlasWriter, GivesTheSameBytesWithAnyNumberOfThreads) {
  const AtlasContent& content = large_content();
  WriteOptions options{.level = 5, .threads = 1};
  const auto alone = encode_atlas(content, options).value();
  for (const unsigned threads : {2u, 8u, 0u}) {
    options.threads = threads;
    EXPECT_TRUE(encode_atlas(content, options).value() == alone) << threads;
  }
  EXPECT_EQ(difference(content, (*Atlas::open_bytes(alone))->read_all().value()), "");
}

RC_GTEST_PROP(AtlasWriter, RewritesWhatWasReadToTheSameBytes, ()) {
  auto random = *random_source();
  const AtlasContent content = random_content(random);
  const WriteOptions options{.level = 3,
                             .compact = *rc::gen::arbitrary<bool>(),
                             .means_from = *rc::gen::inRange<std::uint64_t>(0, 200)};
  const auto bytes = encode_atlas(content, options).value();
  const AtlasContent read = (*Atlas::open_bytes(bytes))->read_all().value();
  RC_ASSERT(encode_atlas(read, options).value() == bytes);
}

TEST(AtlasWriter, CompactLeavesOutTheRunModelsOfXAndY) {
  const AtlasContent& content = large_content();
  const auto atlas = *Atlas::open_bytes(*encode_atlas(content, {.level = 1, .compact = true}));
  std::vector<std::string> names;
  for (const SectionSize& section : atlas->sections()) names.push_back(section.name);
  EXPECT_THAT(names, ElementsAre("header", "directory", "runs_z", "values", "normals", "surfaces"));
}

TEST(AtlasWriter, ReportsProgressThatNeverFallsAndEndsAtOne) {
  const AtlasContent& content = large_content();
  const std::thread::id caller = std::this_thread::get_id();
  std::vector<double> fractions;
  const auto report = [&](double fraction) {
    EXPECT_TRUE(std::this_thread::get_id() == caller);
    fractions.push_back(fraction);
  };
  ASSERT_TRUE(encode_atlas(content, {.level = 1, .progress = report}));
  EXPECT_GT(fractions.size(), 10u);
  EXPECT_TRUE(std::ranges::is_sorted(fractions));
  EXPECT_EQ(fractions.front(), 0);
  EXPECT_EQ(fractions.back(), 1);
}

/// A ball in 6 x 5 x 4 voxels, with values, surface, normals and a scene.
AtlasContent sound_content() {
  const auto is_rich = [](const AtlasContent& c) {
    return c.classes.size() > 2 && !c.values.empty() && !c.scenes.empty() &&
           std::ranges::any_of(c.surfaces, [](const SurfaceMesh& m) { return !m.empty(); }) &&
           !c.boundary_normals[1].empty() && c.classes.voxels(1) > 1;
  };
  return random_content_with(is_rich, 11, {6, 3, 12});
}

std::string refusal_of(const std::function<void(AtlasContent&)>& change) {
  AtlasContent content = sound_content();
  change(content);
  const auto bytes = encode_atlas(content);
  if (bytes) return "";
  EXPECT_EQ(bytes.error().code, ErrorCode::kFailed);
  EXPECT_THAT(bytes.error().message, HasSubstr("cannot write this atlas: "));
  return bytes.error().message;
}

TEST(AtlasWriter, RefusesContentThatDoesNotFitTogether) {
  EXPECT_EQ(refusal_of([](AtlasContent&) {}), "");
  struct Fault {
    void (*change)(AtlasContent& content);
    const char* part;
  };
  constexpr Fault kFaults[] = {
      {[](auto& c) { c.source_grid.spacing_mm[0] = 0; }, "source grid"},
      {[](auto& c) { c.source_to_storage.from[0] = 3; }, "axis order"},
      {[](auto& c) { c.class_volume.pop_back(); }, "class volume has"},
      {[](auto& c) { c.values.bytes.pop_back(); }, "values have"},
      {[](auto& c) { c.values.type = VoxelType::kNone; }, "values have"},
      {[](auto& c) { c.surfaces.emplace_back(); }, "surfaces of"},
      {[](auto& c) { c.boundary_normals.pop_back(); }, "normals of"},
      {[](auto& c) { c.boundary_normals[1].pop_back(); }, "class 1 has"},
      {[](auto& c) { c.boundary_normals[0].push_back(0); }, "class 0 has"},
      {[](auto& c) { c.class_volume[0] = 99; }, "voxel (0, 0, 0) is of class 99"},
      {[](auto& c) { c.scenes[0].zoom = std::numeric_limits<double>::infinity(); }, "camera of scene 0"},
      {[](auto& c) { c.provenance.title = "\xff"; }, "not UTF-8"},
      {[](auto& c) {
         auto mesh = std::ranges::find_if(c.surfaces, [](const SurfaceMesh& m) { return !m.empty(); });
         mesh->triangles[0][0] = 1000;
       },
       "surface of structure '"},
      // Class tables of another volume: the same number of voxels in other places, ...
      {[](auto& c) { *std::ranges::find(c.class_volume, ClassId{1}) = 2; }, "voxels, its table says"},
      {[](auto& c) {
         const Index3 size = storage_grid(c).size;
         c.classes.count(1, 0, IndexBox{{0, 0, 0}, {size[0] - 1, size[1] - 1, size[2] - 1}});
       },
       "the box of class 1"},
      {[](auto& c) {
         std::vector<ClassId> swapped(c.classes.size());
         std::iota(swapped.begin(), swapped.end(), ClassId{0});
         std::swap(swapped[1], swapped[2]);
         c.classes = c.classes.renumbered(swapped);
         for (ClassId& voxel : c.class_volume) voxel = swapped[voxel];
         std::swap(c.boundary_normals[1], c.boundary_normals[2]);
       },
       "not in storage order"},
      {[](auto& c) {
         c.classes.intern({Membership{500, Part::kInterior}});
         c.boundary_normals.emplace_back();
       },
       "belongs to structure 500"},
  };
  for (const auto& [change, part] : kFaults) EXPECT_THAT(refusal_of(change), HasSubstr(part));
}

TEST(AtlasWriter, RefusesLevelsThatZstandardDoesNotHave) {
  for (const int level : {-1, 0, 23})
    EXPECT_EQ(encode_atlas(sound_content(), {.level = level}).error().code, ErrorCode::kUsage) << level;
}

TEST(AtlasWriter, WritesFilesWholeOrNotAtAll) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "a.atlas";
  const AtlasContent content = sound_content();
  ASSERT_TRUE(write_atlas(content, path));
  EXPECT_EQ(difference(content, (*Atlas::open(path))->read_all().value()), "");

  AtlasContent broken = content;
  broken.class_volume.pop_back();
  EXPECT_THAT(message_of(write_atlas(broken, path)), HasSubstr(path.string() + ": cannot write this atlas"));
  EXPECT_EQ(difference(content, (*Atlas::open(path))->read_all().value()), "");
  EXPECT_THAT(folder.names(), ElementsAre("a.atlas"));

  EXPECT_THAT(write_atlas(content, folder.path() / "none" / "a.atlas"),
              FailsWith(ErrorCode::kFailed, HasSubstr("there is no folder")));
}

}  // namespace
}  // namespace splatlas
