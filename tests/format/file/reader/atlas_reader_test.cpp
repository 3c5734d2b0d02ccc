#include "format/atlas_reader.h"

#include <numeric>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "format/atlas_writer.h"
#include "format/codec/value_codec.h"
#include "format/derive/boundary_split.h"
#include "format/derive/run_fingerprint.h"
#include "format/derive/value_groups.h"
#include "format/io/checksum.h"
#include "tests/format/atlas_surgery.h"
#include "tests/format/random_content.h"
#include "tests/support/fails_with.h"
#include "tests/support/message_of.h"

namespace splatlas {
namespace {

Bytes encode(const AtlasContent& content, bool compact = false) {
  return encode_atlas(content, {.level = 1, .compact = compact}).value();
}

RC_GTEST_PROP(Atlas, ReadsWhatWasWritten, ()) {
  auto random = *random_source();
  const AtlasContent content = random_content(random);
  for (const bool compact : {false, true}) {
    const auto atlas = Atlas::open_bytes(encode(content, compact)).value();
    RC_ASSERT(difference(content, atlas->read_all().value()) == "");
    const auto verified = atlas->verify();
    if (!verified) RC_FAIL(verified.error().message);
    for (const Axis axis : kAxes) {
      const RunModel model =
          encode_runs(content.class_volume, atlas->grid().size, axis, content.classes.size());
      RC_ASSERT(atlas->runs(axis) == model.runs());
      for (ClassId c = 1; c < content.classes.size(); ++c)
        RC_ASSERT(*atlas->read_runs(c, axis) == model.classes[c]);
    }
  }
}

RC_GTEST_PROP(Atlas, TellsAboutItselfWithoutReadingChunks, ()) {
  auto random = *random_source();
  const AtlasContent content = random_content(random);
  const Bytes file = encode(content);
  const auto atlas = Atlas::open_bytes(file, "name").value();
  RC_ASSERT(atlas->name() == "name");
  RC_ASSERT(atlas->format_version() == "1.0");
  RC_ASSERT(atlas->grid() == storage_grid(content));
  RC_ASSERT(atlas->value_type() == content.values.type);
  RC_ASSERT(atlas->label_type() == content.label_type);
  for (StructureIndex s = 0; s < content.graph.size(); ++s) {
    RC_ASSERT(atlas->triangles(s) == content.surfaces[s].triangles.size());
  }
  std::uint64_t sum = 0;
  for (const SectionSize& section : atlas->sections()) sum += section.bytes;
  RC_ASSERT(sum == file.size());
  RC_ASSERT(atlas->counters().file == file.size());
  RC_ASSERT(atlas->counters().read == sizeof(FileHeader) + directory_bytes(file).size());
  RC_ASSERT(atlas->counters().decoded == 0u);
}

/// Stored and decoded bytes of the chunks of these streams.
std::pair<std::uint64_t, std::uint64_t> cost_of_all(const AtlasParts& parts, SectionKind kind,
                                                    const std::vector<ClassId>& streams) {
  const FileLayout layout = lay_out(parts.directory, 0).value();
  const SectionLayout* section = layout.find(kind);
  std::pair<std::uint64_t, std::uint64_t> cost{0, 0};
  if (!section) return cost;
  for (std::size_t chunk = 0; chunk + 1 < section->chunk_begin.size(); ++chunk) {
    const std::uint64_t begin = section->chunk_begin[chunk], end = section->chunk_begin[chunk + 1];
    const auto holds = [&](std::size_t n) {
      return section->stream_begin[n] < section->stream_begin[n + 1] &&
             begin < section->stream_begin[n + 1] && end > section->stream_begin[n];
    };
    if (std::ranges::none_of(streams, holds)) continue;
    cost.first += parts.chunks[section->first_chunk + chunk].size();
    cost.second += end - begin;
  }
  return cost;
}
std::pair<std::uint64_t, std::uint64_t> cost_of(const AtlasParts& parts, SectionKind kind, std::size_t n) {
  return cost_of_all(parts, kind, {static_cast<ClassId>(n)});
}

/// The class whose stream contains the runs of a class.
ClassId run_stream(const AtlasParts& parts, ClassId c, Axis axis) {
  const RunStreams streams(parts.directory.classes);
  const auto bytes_of = [&](ClassId of) {
    return parts.directory.run_bytes[of][static_cast<std::size_t>(axis)];
  };
  return streams.is_shared(parts.directory.classes, c, bytes_of) ? streams.pair_of(c)[0] : c;
}

/// Stored bytes for the values of a class: those of its group, and the runs that locate the group.
std::uint64_t cost_of_values(const AtlasParts& parts, const AtlasContent& content, ClassId c) {
  if (content.values.empty()) return 0;
  const ValueGroups groups(content.classes);
  const std::size_t g = groups.group_of[c];
  std::vector<ClassId> of = groups.classes[g];
  const std::uint64_t voxels = group_voxels(groups, content.classes, g);
  const IndexBox box = group_box(groups, content.classes, g, storage_grid(content).size);
  if (voxels == 0) return 0;
  if (of.size() == 1 && !predicts_values(content.values.type, box, voxels)) of.clear();
  if (!of.empty() && of.front() == kEmptyClass) {
    of.resize(content.classes.size());
    std::iota(of.begin(), of.end(), ClassId{0});
  }
  for (ClassId& each : of) each = run_stream(parts, each, Axis::kZ);
  return cost_of(parts, SectionKind::kValues, g).first + cost_of_all(parts, SectionKind::kRunsZ, of).first;
}

RC_GTEST_PROP(Atlas, ReadsTheChunksOfWhatIsAskedForAndNoOthers, ()) {
  auto random = *random_source();
  const AtlasContent content = random_content(random, {30, 8, 500});
  const Bytes file = encode(content);
  const AtlasParts parts = take_apart(file);
  const auto cost_of_reading = [&](const auto& read) {
    const auto atlas = Atlas::open_bytes(file).value();
    const auto before = atlas->counters();
    read(*atlas);
    read(*atlas);  // reads no further bytes of the file
    const auto after = atlas->counters();
    return after.read - before.read;
  };
  for (ClassId c = 0; c < content.classes.size(); ++c) {
    for (const Axis axis : kAxes) {
      RC_ASSERT(cost_of_reading([&](const Atlas& a) { a.read_runs(c, axis).value(); }) ==
                cost_of(parts, run_section(axis), run_stream(parts, c, axis)).first);
    }
    RC_ASSERT(cost_of_reading([&](const Atlas& a) { a.read_values(c).value(); }) ==
              cost_of_values(parts, content, c));
    RC_ASSERT(cost_of_reading([&](const Atlas& a) { a.read_normals(c).value(); }) ==
              cost_of(parts, SectionKind::kNormals, c).first);
  }
  for (std::size_t n = 0; n < content.graph.size(); ++n) {
    const StructureIndex s = content.graph.preorder()[n];
    RC_ASSERT(cost_of_reading([&](const Atlas& a) { a.read_surface(s).value(); }) ==
              cost_of(parts, SectionKind::kSurfaces, n).first);
  }
}

TEST(Atlas, ReadingEverythingTouchesEveryByteOnce) {
  const auto atlas = Atlas::open_bytes(encode(random_content(5, {40, 8, 500}))).value();
  ASSERT_TRUE(atlas->verify());
  ASSERT_TRUE(atlas->verify());
  EXPECT_EQ(atlas->counters().read, atlas->counters().file);
}

TEST(Atlas, SharesChunksAmongSmallClassesOnly) {
  const AtlasParts parts = take_apart(encode(random_content(8, {40, 8, 500})));
  const std::vector<std::uint64_t> sizes = stream_sizes(parts.directory, SectionKind::kValues);
  for (std::size_t g = 0; g < sizes.size(); ++g) {
    const std::uint64_t decoded = cost_of(parts, SectionKind::kValues, g).second;
    EXPECT_LE(decoded, std::max<std::uint64_t>(sizes[g], 512)) << "group " << g;
  }
}

TEST(Atlas, IsSafeToReadFromSeveralThreads) {
  const AtlasContent content = random_content(6, {40, 8, 500});
  const auto atlas = Atlas::open_bytes(encode(content)).value();
  std::vector<std::thread> threads;
  std::vector<std::string> differences(8, "not run");
  for (std::string& found : differences) {
    threads.emplace_back([&] {
      const auto read = atlas->read_all();
      found = read ? difference(content, *read) : read.error().message;
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_THAT(differences, ::testing::Each(""));
  ASSERT_TRUE(atlas->verify());
  EXPECT_EQ(atlas->counters().read, atlas->counters().file);
}

TEST(Atlas, ClassesAndStructuresOutOfRangeAreErrors) {
  const auto atlas = Atlas::open_bytes(encode(random_content(7))).value();
  const auto classes = static_cast<ClassId>(atlas->classes().size());
  EXPECT_EQ(atlas->read_runs(classes, Axis::kX).error().code, ErrorCode::kUsage);
  EXPECT_EQ(atlas->read_values(classes).error().code, ErrorCode::kUsage);
  EXPECT_EQ(atlas->read_normals(kNoStructure).error().code, ErrorCode::kUsage);
  EXPECT_EQ(atlas->read_surface(kNoStructure).error().code, ErrorCode::kUsage);
}

/// A file of 9 MB that declares 8 TiB of values, in chunks of 16 MiB.
TEST(Atlas, RefusesStreamsThatNeedMoreMemoryThanThereIs) {
  AtlasParts parts;
  Directory& directory = parts.directory;
  directory.source_grid.size = {1 << 20, 1 << 20, 1};
  directory.value_type = VoxelType::kFloat64;
  directory.classes.count(kEmptyClass, std::uint64_t{1} << 40, {});
  directory.normals_fitted.resize(1);
  directory.fingerprints = {RunFingerprinter(directory.source_grid.size).of_grid()};
  directory.run_bytes.resize(1);
  constexpr std::uint32_t kChunks = 1u << 19, kChunkBytes = 1u << 24;
  const Bytes stored{std::byte{0}};
  parts.chunks.assign(kChunks, stored);
  directory.chunks.assign(kChunks, {checksum_of(stored), 1, ChunkCodec::kStored, 0});
  directory.sections = {
      {3, 0, kChunkBytes, 0}, {4, kChunks, kChunkBytes, 0}, {5, 0, kChunkBytes, 0}, {6, 0, kChunkBytes, 0}};
  const auto atlas = value_or_throw(Atlas::open_bytes(put_together(parts)));
  EXPECT_THAT(atlas->read_values(kEmptyClass),
              FailsWith(ErrorCode::kLimit, HasSubstr("(memory): takes 8388608 MiB of memory at once")));
  EXPECT_THAT(atlas->verify(), FailsWith(ErrorCode::kInvalidAtlas, HasSubstr("damaged: 1 bytes")));
}

/// A cube of 2^33 voxels in a file of 1 kB.
TEST(Atlas, RefusesToDeriveWhatTakesMemoryByTheVoxel) {
  AtlasParts parts;
  Directory& directory = parts.directory;
  directory.source_grid.size = {1 << 11, 1 << 11, 1 << 11};
  directory.graph = *StructureGraph::build({{"cube", "", {}, {}, {}, false}});
  const ClassId cube = directory.classes.intern({{0, Part::kInterior}});
  directory.classes.count(cube, std::uint64_t{1} << 33, {{0, 0, 0}, {2047, 2047, 2047}});
  directory.run_totals = {1 << 22, 1 << 22, 1 << 22};
  directory.surfaces = {{3, 1, 4, 0}};
  directory.normals_fitted.resize(2);
  directory.fingerprints = {0, RunFingerprinter(directory.source_grid.size).of_grid()};
  parts.chunks = {Bytes(4)};
  directory.run_bytes = {{}, {0, 0, 4}};
  directory.chunks = {{checksum_of(parts.chunks[0]), 4, ChunkCodec::kStored, 0}};
  directory.sections = {{3, 1, 262'144, 4}, {5, 0, 262'144, 4}, {6, 0, 262'144, 4}};
  const auto atlas = value_or_throw(Atlas::open_bytes(put_together(parts)));
  EXPECT_THAT(
      atlas->read_runs(cube, Axis::kX),
      FailsWith(ErrorCode::kLimit,
                "(memory): class 1 has 8589934592 voxels, too many to derive a run model from another"));
}

TEST(Atlas, OpensFilesOfNewerMinorVersionsAndSkipsTheirSections) {
  const AtlasContent content = random_content(9);
  AtlasParts parts = take_apart(encode(content));
  const EncodedChunk extra = encode_chunk(Bytes(1000, std::byte{1}), 3);
  parts.directory.sections.insert(parts.directory.sections.begin(), {4711, 1, 5, 7});
  parts.directory.chunks.insert(parts.directory.chunks.begin(), extra.entry);
  parts.directory.chunks[0].codec = static_cast<ChunkCodec>(9);
  parts.chunks.insert(parts.chunks.begin(), extra.bytes);
  Bytes file = put_together(parts);
  edit_header(file, [](FileHeader& header) {
    header.minor = 3;
    header.optional_features = 1;
  });

  const auto atlas = Atlas::open_bytes(file).value();
  EXPECT_EQ(atlas->format_version(), "1.3");
  EXPECT_EQ(difference(content, atlas->read_all().value()), "");
  EXPECT_TRUE(atlas->verify());
  EXPECT_EQ(atlas->sections()[2].name, "section 4711");

  // Unknown chunks are checked for damage.
  file[sizeof(FileHeader) + header_of(file).directory_bytes + 3] ^= std::byte{1};
  EXPECT_EQ(message_of(Atlas::open_bytes(file).value()->verify()),
            "(memory): damaged: checksum of section 4711 chunk 0");
}

}  // namespace
}  // namespace splatlas
