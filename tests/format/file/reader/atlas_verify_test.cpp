// Detection of damage by open() and verify(): truncation, flipped bits, tampering with right checksums.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

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
  static const Bytes file = encode_atlas(small_content()).value();
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

TEST(AtlasDamage, TrailingBytesAreAnError) {
  Bytes file = small_file();
  file.push_back(std::byte{0});
  EXPECT_THAT(fault_of_file(file), HasSubstr("1 trailing bytes"));
}

TEST(AtlasDamage, EveryFlippedByteIsFound) {
  const Bytes& file = small_file();
  for (std::size_t n = 0; n < file.size(); ++n) {
    for (const int mask : {0x01, 0x80, 0xff}) {
      Bytes flipped = file;
      flipped[n] ^= static_cast<std::byte>(mask);
      EXPECT_THAT(fault_of_file(flipped), AnyOf(HasSubstr("damaged: checksum"), HasSubstr("not an atlas")))
          << n;
    }
  }
}

TEST(AtlasDamage, ChecksumFaultsNameWhatIsDamaged) {
  const AtlasParts parts = take_apart(small_file());
  const FileLayout layout = lay_out(parts.directory, directory_bytes(small_file()).size()).value();
  const std::vector<std::string> expected{"runs_x of class", "runs_y of class",  "runs_z of class",
                                          "values of class", "normals of class", "surfaces of structure"};
  ASSERT_EQ(layout.sections.size(), expected.size());
  for (std::size_t n = 0; n < expected.size(); ++n) {
    Bytes file = small_file();
    file[layout.chunk_offset[layout.sections[n].first_chunk]] ^= std::byte{1};
    EXPECT_THAT(fault_of_file(file), HasSubstr("F: damaged: checksum of " + expected[n]));
  }
}

/// Every directory byte, changed under right checksums. Any outcome is allowed except a crash, a hang or a
/// sanitizer report. Many such files are valid, with other colours or names.
TEST(AtlasDamage, ForgedDirectoriesDoNoHarm) {
  const AtlasParts parts = take_apart(small_file());
  const Bytes directory = directory_bytes(small_file());
  std::size_t refused = 0;
  for (std::size_t n = 0; n < directory.size(); ++n) {
    for (const int mask : {0x01, 0x40, 0x80, 0xff}) {
      Bytes forged = directory;
      forged[n] ^= static_cast<std::byte>(mask);
      refused += !fault_of_file(put_together(forged, parts.chunks)).empty();
    }
  }
  EXPECT_GT(refused, directory.size());
  EXPECT_LT(refused, 4 * directory.size());
}

RC_GTEST_PROP(AtlasDamage, ForgedWordsDoNoHarm, ()) {
  auto random = *random_source();
  const AtlasContent content = random_content(random, {6, 5, 12});
  const Bytes file = encode_atlas(content, {.level = 1}).value();
  const AtlasParts parts = take_apart(file);
  const Bytes directory = directory_bytes(file);
  const std::array<std::uint32_t, 7> words{0, 1, 4, 0x7fffffff, 0x80000000, 0xfffffffc, 0xffffffff};
  for (int n = 0; n < 40; ++n) {
    Bytes forged = directory;
    for (std::size_t k = 1 + random() % 3; k > 0; --k) {
      const std::uint32_t word = words[random() % words.size()];
      std::memcpy(forged.data() + random() % (forged.size() / 4) * 4, &word, 4);
    }
    (void)fault_of_file(put_together(forged, parts.chunks));
  }
}

/// Streams changed, recompressed and given right checksums.
RC_GTEST_PROP(AtlasDamage, ForgedStreamsDoNoHarm, ()) {
  auto random = *random_source();
  AtlasParts parts = take_apart(small_file());
  const auto kind = static_cast<SectionKind>(1 + random() % 6);
  std::vector<Bytes> streams = decode_streams(parts, kind);
  for (int n = 0; n < 3; ++n) {
    Bytes& stream = streams[random() % streams.size()];
    if (!stream.empty()) stream[random() % stream.size()] = static_cast<std::byte>(random());
  }
  replace_streams(parts, kind, streams);
  const std::string fault = fault_of_file(put_together(parts));
  if (kind == SectionKind::kNormals) RC_ASSERT(fault == "");  // any bytes are valid
}

/// The fault of the file with other runs of one class along one axis, under right checksums.
std::string fault_with_runs(ClassId c, Axis axis, const std::function<void(ClassRuns&)>& change) {
  AtlasParts parts = take_apart(small_file());
  edit_run_list(parts, c, axis, change);
  return fault_of_file(put_together(parts));
}

TEST(AtlasVerify, FindsRunsThatAreNotThoseOfTheClass) {
  EXPECT_EQ(fault_with_runs(1, Axis::kZ, [](ClassRuns&) {}), "");
  EXPECT_THAT(fault_with_runs(1, Axis::kZ, [](ClassRuns& runs) { ++runs[0].length; }),
              HasSubstr("F: invalid: runs_z of class 1: "));
  EXPECT_THAT(fault_with_runs(2, Axis::kX, [](ClassRuns& runs) { runs.pop_back(); }),
              HasSubstr("F: invalid: runs_x of class 2: "));
  EXPECT_THAT(fault_with_runs(2, Axis::kY, [](ClassRuns& runs) { runs.back().scanline += 1000; }),
              HasSubstr("F: invalid: runs_y of class 2: "));
}

/// Moves a run by one voxel. The bounding box stays, or changes. False if no run can be moved so.
bool move_a_run(ClassRuns& runs, const Index3& size, Axis axis, bool keeps_box) {
  const IndexBox box = box_of(runs, size, axis);
  for (std::size_t n = 0; n < runs.size(); ++n) {
    const bool room = n == 0 || runs[n - 1].scanline != runs[n].scanline ||
                      runs[n - 1].start + runs[n - 1].length + 1 < runs[n].start;
    if (!room || runs[n].start == 0) continue;
    --runs[n].start;
    if ((box_of(runs, size, axis) == box) == keeps_box) return true;
    ++runs[n].start;
  }
  return false;
}

TEST(AtlasVerify, FindsRunModelsThatDiffer) {
  const Index3 size = storage_grid(small_content()).size;
  for (const bool keeps_box : {true, false}) {
    std::size_t moved = 0;
    for (ClassId c = 1; c < small_content().classes.size(); ++c) {
      for (const Axis axis : {Axis::kX, Axis::kY}) {
        ClassRuns runs = (*Atlas::open_bytes(small_file()))->read_runs(c, axis).value();
        if (!move_a_run(runs, size, axis, keeps_box)) continue;
        ++moved;
        const auto move = [&](ClassRuns& to_change) { to_change = runs; };
        EXPECT_THAT(fault_with_runs(c, axis, move),
                    keeps_box ? HasSubstr(fmt::format("class {} covers other voxels than its fingerprint", c))
                              : HasSubstr(fmt::format("the box of class {} does not match its runs_", c)));
      }
    }
    EXPECT_GT(moved, 0u);
  }
}

TEST(AtlasVerify, FindsBoxesThatAreNotTight) {
  AtlasParts parts = take_apart(small_file());
  const Index3 size = storage_grid(small_content()).size;
  parts.directory.classes.count(2, 0, {{0, 0, 0}, {size[0] - 1, size[1] - 1, size[2] - 1}});
  EXPECT_EQ(fault_of_file(put_together(parts)), "F: invalid: the box of class 2 does not match its runs_z");
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

TEST(AtlasVerify, FindsTotalsThatDoNotAddUp) {
  AtlasParts parts = take_apart(small_file());
  --parts.directory.run_totals[1];
  EXPECT_THAT(fault_of_file(put_together(parts)), HasSubstr("F: invalid: runs_y has "));
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

TEST(AtlasVerify, FindsSurfacesThatDoNotDecode) {
  AtlasParts parts = take_apart(small_file());
  std::vector<Bytes> streams = decode_streams(parts, SectionKind::kSurfaces);
  const std::size_t n = static_cast<std::size_t>(
      std::ranges::find_if(streams, [](const Bytes& s) { return !s.empty(); }) - streams.begin());
  streams[n][0] ^= std::byte{1};  // the length of its first part
  replace_streams(parts, SectionKind::kSurfaces, streams);
  const std::string id = parts.directory.graph[parts.directory.graph.preorder()[n]].id;
  EXPECT_THAT(fault_of_file(put_together(parts)),
              HasSubstr("F: invalid: surface of structure '" + id + "': "));
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

/// Declared sizes cost nothing until they are used: small files that declare maximum grids, classes and
/// surfaces.
TEST(AtlasDamage, DeclaredSizesAreCheckedBeforeTheyAreBelieved) {
  AtlasParts parts = take_apart(small_file());
  parts.directory.source_grid.size = {1 << 14, 1 << 13, 1 << 13};
  EXPECT_THAT(fault_of_file(put_together(parts)), HasSubstr("invalid: classes have"));

  parts.directory.classes.count(
      0, (std::uint64_t{1} << 40) - static_cast<std::uint64_t>(storage_grid(small_content()).voxels()), {});
  EXPECT_THAT(fault_of_file(put_together(parts)), HasSubstr("invalid: "));

  parts = take_apart(small_file());
  const StructureIndex s = parts.directory.graph.preorder()[0];
  parts.directory.surfaces[s] = {0xffffffff, 0xffffffff, 2, 0xffffffff};
  EXPECT_THAT(fault_of_file(put_together(parts)), HasSubstr("invalid: "));
}

}  // namespace
}  // namespace splatlas
