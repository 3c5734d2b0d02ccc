// Detection of damage by open() and verify(): truncation, flipped bits, tampering with right checksums.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "format/atlas_reader.h"
#include "format/atlas_writer.h"
#include "tests/format/atlas_surgery.h"
#include "tests/format/bad_files/bad_files.h"
#include "tests/format/random_content.h"

namespace splatlas {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;

/// A small atlas with all sections.
AtlasContent small_content() {
  const auto triangles = [](const SurfaceMesh& m) { return !m.triangles.empty(); };
  const auto wanted = [&](const AtlasContent& c) {
    return c.classes.size() > 4 && c.classes.voxels(0) > 0 && c.classes.voxels(1) > 3 &&
           c.classes.voxels(2) > 3 && bytes_of(c.values.type) == 2 && c.scenes.size() == 1 &&
           std::ranges::count_if(c.surfaces, triangles) > 1 && !c.boundary_normals[1].empty();
  };
  return random_content_with(wanted, 2, {7, 5, 12});
}

const Bytes& small_file() {
  static const Bytes file = encode_atlas(small_content(), {.means_from = 1}).value();
  return file;
}

TEST(AtlasDamage, TruncationAtEveryLengthIsToldWithBothSizes) {
  const Bytes& file = small_file();
  ASSERT_EQ(fault_of_file(file), "");
  for (std::size_t length = 0; length < file.size(); ++length) {
    const std::string fault = fault_of_file(slice(file, 0, length));
    if (length == 0) {
      EXPECT_EQ(fault, "F: not an atlas (its size is 0 bytes)");
    } else if (length < sizeof(FileHeader)) {
      EXPECT_THAT(fault, HasSubstr("F: truncated: ")) << length;
    } else {
      EXPECT_EQ(fault, fmt::format("F: truncated: header says {} bytes, file has {}", file.size(), length));
    }
  }
}

/// By verify(); what is read without it is right, or an error.
TEST(AtlasDamage, EveryFlippedByteIsFound) {
  const Bytes& file = small_file();
  const AtlasContent content = small_content();
  for (std::size_t n = 0; n < file.size(); ++n) {
    for (const int mask : {0x01, 0x80, 0xff}) {
      Bytes flipped = file;
      flipped[n] ^= static_cast<std::byte>(mask);
      EXPECT_THAT(fault_of_file(flipped), AnyOf(HasSubstr("damaged: checksum"), HasSubstr("not an atlas")))
          << n;
      const auto atlas = Atlas::open_bytes(flipped);
      if (!atlas) continue;
      const auto read = (*atlas)->read_all();
      EXPECT_TRUE(!read || difference(*read, content) == "") << n;
    }
  }
}

// Found by fuzzing: such a file was accepted, but could not be written again.
TEST(AtlasVerify, FindsABoxOfTheEmptyClassThatIsNotTight) {
  std::mt19937 random(1);
  int grown = 0;
  for (int n = 0; n < 300; ++n) {
    const AtlasContent content =
        random_content(random, {.max_side = 5, .max_structures = 3, .max_vertices = 3});
    const Bytes file = encode_atlas(content, {}).value();
    EXPECT_EQ(fault_of_file(file), "");
    const Index3 size = storage_grid(content).size;
    const IndexBox& box = content.classes.box(kEmptyClass);
    const IndexBox grid{{0, 0, 0}, {size[0] - 1, size[1] - 1, size[2] - 1}};
    if (box.empty() || box == grid) continue;
    ++grown;
    AtlasParts parts = take_apart(file);
    parts.directory.classes.count(kEmptyClass, 0, grid);
    EXPECT_EQ(fault_of_file(put_together(parts)), "F: invalid: the box of class 0 does not match its voxels");
  }
  EXPECT_GT(grown, 50);
}

TEST(AtlasVerify, CountsTheRunsThatACompactFileLeavesOut) {
  AtlasParts parts = take_apart(encode_atlas(small_content(), {.compact = true}).value());
  EXPECT_EQ(fault_of_file(put_together(parts)), "");
  ++parts.directory.run_totals[0];
  EXPECT_THAT(fault_of_file(put_together(parts)), HasSubstr("F: invalid: runs_x has "));
}

TEST(AtlasVerify, FindsClassesThatOverlap) {
  // Two classes of two voxels in a row of six, 0 1 1 2 2 0, then overlapping.
  AtlasContent content;
  content.source_grid.size = {6, 1, 1};
  content.graph = *StructureGraph::build({{"a", "", {}, {}, {}, false}, {"b", "", {}, {}, {}, false}});
  const auto classes_in = [](const IndexBox& box_of_2) {
    ClassTable classes;
    for (const StructureIndex s : {0u, 1u}) classes.intern({{s, Part::kBoundary}});
    classes.count(0, 2, {{0, 0, 0}, {5, 0, 0}});
    classes.count(1, 2, {{1, 0, 0}, {2, 0, 0}});
    classes.count(2, 2, box_of_2);
    return classes;
  };
  content.class_volume = {0, 1, 1, 2, 2, 0};
  content.classes = classes_in({{3, 0, 0}, {4, 0, 0}});
  content.surfaces.resize(2);
  content.boundary_normals = {{}, {0, 0}, {0, 0}};
  for (const bool compact : {false, true}) {
    AtlasParts parts = take_apart(encode_atlas(content, {.compact = compact}).value());
    for (const SectionEntry& section : std::vector(parts.directory.sections)) {
      if (section.kind > 3) continue;
      const auto kind = static_cast<SectionKind>(section.kind);
      std::vector<Bytes> streams = decode_streams(parts, kind);
      streams[2] = streams[1];
      replace_streams(parts, kind, streams);
    }
    parts.directory.classes = classes_in({{1, 0, 0}, {2, 0, 0}});
    EXPECT_EQ(fault_of_file(put_together(parts)),
              "F: invalid: runs_z of class 2 covers other voxels than its fingerprint");
    // Forged fingerprints
    std::vector<VoxelSetFingerprint>& fingerprints = parts.directory.fingerprints;
    fingerprints[0] =
        subtract_fingerprints(add_fingerprints(fingerprints[0], fingerprints[2]), fingerprints[1]);
    fingerprints[2] = fingerprints[1];
    EXPECT_EQ(fault_of_file(put_together(parts)),
              "F: invalid: runs_z of classes 1 and 2 overlap in scanline 0");
  }
}

TEST(AtlasVerify, DamageCostsItsOwnStreamsOnly) {
  const AtlasParts parts = take_apart(small_file());
  const FileLayout layout = lay_out(parts.directory, directory_bytes(small_file()).size()).value();
  Bytes file = small_file();
  file[layout.chunk_offset[layout.find(SectionKind::kValues)->first_chunk]] ^= std::byte{1};
  const auto atlas = Atlas::open_bytes(file).value();
  EXPECT_FALSE(atlas->read_values(0));
  EXPECT_TRUE(atlas->read_normals(1));
  EXPECT_TRUE(atlas->read_runs(1, Axis::kX));
  EXPECT_FALSE(atlas->read_all());
}

}  // namespace
}  // namespace splatlas
