// Means of grey values in blocks, stored and derived.
#include <cmath>
#include <cstring>
#include <map>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "format/atlas_reader.h"
#include "format/atlas_writer.h"
#include "format/derive/value_groups.h"
#include "tests/format/bad_files/bad_files.h"
#include "tests/format/bad_files/good_atlas.h"
#include "tests/format/random_content.h"
#include "tests/format/random_volume.h"

namespace splatlas {
namespace {

std::shared_ptr<const Atlas> atlas_of(const AtlasContent& content, std::uint64_t means_from) {
  return Atlas::open_bytes(encode_atlas(content, {.level = 1, .means_from = means_from}).value()).value();
}

/// Voxels and the mean of a block, as text.
using Blocks = std::map<std::array<std::int64_t, 3>, std::pair<int, std::string>>;

template <typename T>
std::string text_of(T mean) {
  return mean != mean ? "nan" : std::to_string(mean);
}

/// The blocks of all classes in the structures of class `c`, voxel by voxel.
Blocks expected_blocks(const AtlasContent& content, ClassId c) {
  const ValueGroups groups(content.classes);
  const Index3 size = storage_grid(content).size;
  Blocks blocks;
  visit_voxel_type(content.values.type, [&](auto tag) {
    using T = decltype(tag);
    std::map<std::array<std::int64_t, 3>, std::pair<int, double>> sums;
    std::size_t n = 0;
    for_each_voxel(size, [&](const Index3& at) {
      const ClassId of = content.class_volume[n];
      const auto value = static_cast<double>(content.values.as<T>()[n++]);
      if (groups.group_of[of] != groups.group_of[c]) return;
      auto& [voxels, sum] = sums[{at[2] / 4, at[1] / 4, at[0] / 4}];
      ++voxels;
      sum += value;
    });
    for (const auto& [block, of] : sums) {
      const double mean = of.second / of.first;
      const T rounded = std::is_integral_v<T> ? static_cast<T>(std::floor(mean + 0.5)) : static_cast<T>(mean);
      blocks[block] = {of.first, text_of(rounded)};
    }
  });
  return blocks;
}

Blocks blocks_of(const Atlas& atlas, ClassId c) {
  const BlockMeans means = atlas.read_means(c).value();
  const std::int64_t rows = (atlas.grid().size[1] + 3) / 4;
  Blocks blocks;
  std::size_t n = 0;
  for (const Run& run : means.runs) {
    const auto scanline = static_cast<std::int64_t>(run.scanline);
    for (std::uint32_t i = 0; i < run.length; ++i, ++n) {
      visit_voxel_type(atlas.value_type(), [&](auto tag) {
        std::memcpy(&tag, means.values.data() + n * sizeof tag, sizeof tag);
        blocks[{scanline / rows, scanline % rows, run.start + i}] = {means.voxels[n], text_of(tag)};
      });
    }
  }
  return blocks;
}

RC_GTEST_PROP(Means, AreThoseOfTheVoxelsOfEachBlockStoredOrNot, ()) {
  auto random = *random_source();
  const AtlasContent content = random_content(random);
  RC_PRE(!content.values.empty());
  const auto stored = atlas_of(content, 1), derived = atlas_of(content, ~std::uint64_t{0});
  RC_ASSERT(stored->verify().has_value());
  for (ClassId c = 1; c < content.classes.size(); ++c) {
    if (content.classes.voxels(c) == 0) continue;
    RC_ASSERT(stored->has_means(c) && !derived->has_means(c));
    RC_ASSERT(blocks_of(*stored, c) == expected_blocks(content, c));
    RC_ASSERT(blocks_of(*derived, c) == expected_blocks(content, c));
  }
}

TEST(Means, AreStoredForLargeGroupsOfClassesAlone) {
  const auto atlas = atlas_of(good_content(), 27);  // the two classes of the knob have so many
  EXPECT_TRUE(atlas->has_means(good::kKnobInterior) && atlas->has_means(good::kKnobBoundary));
  EXPECT_FALSE(atlas->has_means(good::kRimBoundary) || atlas->has_means(good::kEmpty));
}

TEST(Means, OfBadFilesAreRefused) {
  struct Row {
    const char* what;
    void (*change)(RawAtlas& atlas);
    const char* message;
  };
  constexpr Row kRows[] = {
      {"of no group", [](auto& a) { a.directory.mean_blocks.clear(); },
       "F: invalid: numbers of means of 0 groups, expected 6"},
      {"without the section", [](auto& a) { a.section(SectionKind::kMeans).kind = 77; },
       "F: invalid: numbers of means of 6 groups, expected 0"},
      {"of the empty class", [](auto& a) { a.directory.mean_blocks[0] = 4; },
       "F: invalid: 4 means of the 131 voxels of class 0"},
      {"fewer than the stream holds", [](auto& a) { a.directory.mean_blocks[4] = 0; },
       "F: damaged: wrong frame length (expected 325 bytes) of means of classes 1 to 7"},
      {"more than the box holds", [](auto& a) { a.directory.mean_blocks[4] = 9; },
       "F: invalid: 9 means of the 27 voxels of class 5"},
      {"another mean",
       [](auto& a) { a.edit_stream(SectionKind::kMeans, 4, [](Bytes& b) { b.back() ^= std::byte{2}; }); },
       "F: invalid: means of class 5 are not those of its values"},
  };
  const Bytes file = encode_atlas(good_content(), {.means_from = 1}).value();
  EXPECT_EQ(fault_of_file(file), "");
  AtlasContent without_values = good_content();
  without_values.values = {};
  RawAtlas no_values = raw_atlas(encode_atlas(without_values).value());
  no_values.directory.sections.push_back({7, 0, 262144, 512});
  EXPECT_EQ(fault_of_file(file_of(no_values)), "F: invalid: means without a value type");
  for (const Row& row : kRows) {
    RawAtlas atlas = raw_atlas(file);
    row.change(atlas);
    EXPECT_EQ(fault_of_file(file_of(atlas)), row.message) << row.what;
  }
}

}  // namespace
}  // namespace splatlas
