// Second reader against the library.
#include "tests/format/second_reader/second_reader.h"

#include <random>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "format/atlas_reader.h"
#include "format/atlas_writer.h"
#include "format/codec/mask_codec.h"
#include "tests/format/atlas_surgery.h"
#include "tests/format/golden/golden_contents.h"
#include "tests/format/random_content.h"

namespace splatlas {
namespace {

/// The first part in which the second reader differs from the written content; "" for none.
std::string difference(const AtlasContent& content, const std::vector<std::byte>& file) {
  const second::Atlas read = second::read_atlas(file);
  if (read.size != storage_grid(content).size) return "size";
  for (const auto& volume : read.class_volume) {
    if (!volume.empty() && volume != content.class_volume) return "class volume";
  }
  if (read.class_volume[2] != content.class_volume) return "class volume along z";
  if (read.values != content.values.bytes) return "values";
  for (std::size_t c = 0; c < read.normals.size(); ++c) {
    if (!read.normals[c].empty() && read.normals[c] != content.boundary_normals[c]) return "normals";
  }
  return "";
}

TEST(SecondReader, ReadsTheContentsOfGoldenFiles) {
  for (const GoldenContent& golden : golden_contents()) {
    const auto file = encode_atlas(golden.content, {.compact = golden.compact, .means_from = 1}).value();
    EXPECT_EQ(difference(golden.content, file), "") << golden.name;
  }
}

/// Irregular voxels of one slice: a structure without interior voxels, whose interior class exists.
AtlasContent hollow_content() {
  AtlasContent content;
  content.source_grid.size = {40, 40, 40};
  content.graph = StructureGraph::build({{.id = "hollow"}}).value();
  const ClassId interior = content.classes.intern({{0, Part::kInterior}});
  const ClassId boundary = content.classes.intern({{0, Part::kBoundary}});
  content.class_volume.assign(40 * 40 * 40, kEmptyClass);
  std::mt19937 random(5);
  IndexBox box;
  std::uint64_t voxels = 0;
  for (std::int64_t j = 10; j < 30; ++j) {
    for (std::int64_t i = 10; i < 30; ++i) {
      if (random() % 2 == 0) continue;
      box.include({{i, j, 10}, {i, j, 10}});
      content.class_volume[static_cast<std::size_t>(content.source_grid.offset(i, j, 10))] = boundary;
      ++voxels;
    }
  }
  content.classes.count(kEmptyClass, content.class_volume.size() - voxels, {{0, 0, 0}, {39, 39, 39}});
  content.classes.count(interior, 0, {});
  content.classes.count(boundary, voxels, box);
  content.surfaces.resize(1);
  content.boundary_normals = {{}, {}, std::vector<PackedNormal>(voxels)};
  return content;
}

TEST(SecondReader, ReadsAListOfAClassWithoutVoxels) {
  for (const bool compact : {false, true}) {
    const AtlasContent content = hollow_content();
    const auto file = encode_atlas(content, {.compact = compact}).value();
    EXPECT_EQ(difference(content, file), "") << compact;
    const auto atlas = Atlas::open_bytes(file).value();
    EXPECT_TRUE(atlas->verify()) << compact;
    EXPECT_EQ(atlas->read_all()->class_volume, content.class_volume) << compact;
    const AtlasParts parts = take_apart(file);
    EXPECT_EQ(parts.directory.run_bytes[2][2], 0u);
    const Bytes stream = decode_streams(parts, SectionKind::kRunsZ)[1];
    ASSERT_FALSE(stream.empty());
    EXPECT_EQ(stream.front() == kMaskMark, compact);
  }
}

RC_GTEST_PROP(SecondReader, ReadsRandomAtlases, ()) {
  auto random = *random_source();
  const AtlasContent content = random_content(random, {9, 6, 20});
  const auto file =
      encode_atlas(content, {.level = 1, .compact = random() % 2 == 0, .means_from = 9}).value();
  RC_ASSERT(difference(content, file) == "");
}

}  // namespace
}  // namespace splatlas
