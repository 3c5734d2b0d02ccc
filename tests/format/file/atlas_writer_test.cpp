#include "format/atlas_writer.h"

#include <fstream>
#include <functional>
#include <limits>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "format/atlas_reader.h"
#include "tests/format/random_content.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// An atlas with several chunks in most sections.
const AtlasContent& large_content() {
  static const AtlasContent found = [] {
    std::mt19937 random(3);
    for (;;) {
      AtlasContent content = random_content(random, {80, 8, 10'000});
      const std::size_t values = content.values.bytes.size();
      if (content.graph.size() > 5 && values > 500'000 && values < 1'000'000) return content;
    }
  }();
  return found;
}

TEST(AtlasWriter, GivesTheSameBytesWithAnyNumberOfThreads) {
  const AtlasContent& content = large_content();
  WriteOptions options;
  options.level = 5;
  options.threads = 1;
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
  WriteOptions options;
  options.level = 3;
  options.compact = *rc::gen::arbitrary<bool>();
  const auto bytes = encode_atlas(content, options).value();
  const AtlasContent read = (*Atlas::open_bytes(bytes))->read_all().value();
  RC_ASSERT(encode_atlas(read, options).value() == bytes);
}

TEST(AtlasWriter, LevelTradesTimeForSize) {
  const AtlasContent& content = large_content();
  WriteOptions fast, small;
  fast.level = 1;
  small.level = 16;
  EXPECT_LT(encode_atlas(content, small)->size(), encode_atlas(content, fast)->size());
}

TEST(AtlasWriter, CompactLeavesOutTheRunModelsOfXAndY) {
  const AtlasContent& content = large_content();
  WriteOptions options;
  options.level = 1;
  options.compact = true;
  const auto atlas = *Atlas::open_bytes(*encode_atlas(content, options));
  std::vector<std::string> names;
  for (const SectionSize& section : atlas->sections()) names.push_back(section.name);
  EXPECT_THAT(names, ElementsAre("header", "directory", "runs_z", "values", "normals", "surfaces"));
}

TEST(AtlasWriter, ReportsProgressThatNeverFallsAndEndsAtOne) {
  const AtlasContent& content = large_content();
  WriteOptions options;
  options.level = 1;
  const std::thread::id caller = std::this_thread::get_id();
  std::vector<double> fractions;
  options.progress = [&](double fraction) {
    EXPECT_TRUE(std::this_thread::get_id() == caller);
    fractions.push_back(fraction);
  };
  ASSERT_TRUE(encode_atlas(content, options));
  EXPECT_GT(fractions.size(), 10u);
  EXPECT_TRUE(std::ranges::is_sorted(fractions));
  EXPECT_EQ(fractions.front(), 0);
  EXPECT_EQ(fractions.back(), 1);
}

/// A ball in 6 x 5 x 4 voxels, with values, surface, normals and a scene.
AtlasContent sound_content() {
  std::mt19937 random(11);
  for (;;) {
    AtlasContent content = random_content(random, {6, 3, 12});
    const bool rich =
        content.classes.size() > 2 && !content.values.empty() && !content.scenes.empty() &&
        std::ranges::any_of(content.surfaces, [](const SurfaceMesh& m) { return !m.empty(); }) &&
        !content.boundary_normals[1].empty() && content.classes.voxels(1) > 1;
    if (rich) return content;
  }
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
  EXPECT_THAT(refusal_of([](AtlasContent& c) { c.source_grid.spacing_mm[0] = 0; }), HasSubstr("source grid"));
  EXPECT_THAT(refusal_of([](AtlasContent& c) {
                c.source_to_storage.from = {3, 1, 0};
              }),
              HasSubstr("axis order"));
  EXPECT_THAT(refusal_of([](AtlasContent& c) { c.class_volume.pop_back(); }), HasSubstr("class volume has"));
  EXPECT_THAT(refusal_of([](AtlasContent& c) { c.values.bytes.pop_back(); }), HasSubstr("values have"));
  EXPECT_THAT(refusal_of([](AtlasContent& c) { c.values.type = VoxelType::kNone; }),
              HasSubstr("values have"));
  EXPECT_THAT(refusal_of([](AtlasContent& c) { c.surfaces.emplace_back(); }), HasSubstr("surfaces of"));
  EXPECT_THAT(refusal_of([](AtlasContent& c) { c.boundary_normals.pop_back(); }), HasSubstr("normals of"));
  EXPECT_THAT(refusal_of([](AtlasContent& c) { c.boundary_normals[1].pop_back(); }),
              HasSubstr("class 1 has"));
  EXPECT_THAT(refusal_of([](AtlasContent& c) { c.boundary_normals[0].push_back(0); }),
              HasSubstr("class 0 has"));
  EXPECT_THAT(refusal_of([](AtlasContent& c) { c.class_volume[0] = 99; }),
              HasSubstr("voxel (0, 0, 0) is of class 99"));
  EXPECT_THAT(refusal_of([](AtlasContent& c) { c.scenes[0].zoom = std::numeric_limits<double>::infinity(); }),
              HasSubstr("camera of scene 0"));
  EXPECT_THAT(refusal_of([](AtlasContent& c) { c.provenance.title = std::string("\xff"); }),
              HasSubstr("not UTF-8"));
  EXPECT_THAT(refusal_of([](AtlasContent& c) {
                auto mesh = std::ranges::find_if(c.surfaces, [](const SurfaceMesh& m) { return !m.empty(); });
                mesh->triangles[0][0] = 1000;
              }),
              HasSubstr("surface of structure '"));
}

TEST(AtlasWriter, RefusesClassTablesOfAnotherVolume) {
  EXPECT_THAT(refusal_of([](AtlasContent& c) {
                const auto one = std::ranges::find(c.class_volume, ClassId{1});
                *one = 2;  // the same number of voxels in other places
              }),
              HasSubstr("voxels, its table says"));
  EXPECT_THAT(
      refusal_of([](AtlasContent& c) {
        ClassTable wide = c.classes;
        wide.count(1, 0,
                   {{0, 0, 0},
                    {storage_grid(c).size[0] - 1, storage_grid(c).size[1] - 1, storage_grid(c).size[2] - 1}});
        c.classes = wide;
      }),
      HasSubstr("the box of class 1"));
  EXPECT_THAT(refusal_of([](AtlasContent& c) {
                std::vector<ClassId> swapped(c.classes.size());
                std::iota(swapped.begin(), swapped.end(), ClassId{0});
                std::swap(swapped[1], swapped[2]);
                c.classes = c.classes.renumbered(swapped);
                for (ClassId& voxel : c.class_volume) voxel = swapped[voxel];
                std::swap(c.boundary_normals[1], c.boundary_normals[2]);
              }),
              HasSubstr("not in storage order"));
  EXPECT_THAT(refusal_of([](AtlasContent& c) {
                c.classes.intern({{500, Part::kInterior}});
                c.boundary_normals.emplace_back();
              }),
              HasSubstr("belongs to structure 500"));
}

TEST(AtlasWriter, RefusesLevelsThatZstandardDoesNotHave) {
  WriteOptions options;
  for (const int level : {-1, 0, 23}) {
    options.level = level;
    EXPECT_EQ(encode_atlas(sound_content(), options).error().code, ErrorCode::kUsage) << level;
  }
}

TEST(AtlasWriter, WritesFilesWholeOrNotAtAll) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "a.atlas";
  const AtlasContent content = sound_content();
  ASSERT_TRUE(write_atlas(content, path));
  EXPECT_EQ(difference(content, (*Atlas::open(path))->read_all().value()), "");

  AtlasContent broken = content;
  broken.class_volume.pop_back();
  const auto refused = write_atlas(broken, path);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr(path.string() + ": cannot write this atlas"));
  EXPECT_EQ(difference(content, (*Atlas::open(path))->read_all().value()), "");
  EXPECT_THAT(folder.names(), ElementsAre("a.atlas"));

  const auto unwritable = write_atlas(content, folder.path() / "none" / "a.atlas");
  ASSERT_FALSE(unwritable);
  EXPECT_EQ(unwritable.error().code, ErrorCode::kFailed);
  EXPECT_THAT(unwritable.error().message, HasSubstr("No such file or directory"));
}

}  // namespace
}  // namespace splatlas
