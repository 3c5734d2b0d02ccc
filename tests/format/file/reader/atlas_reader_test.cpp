#include "format/atlas_reader.h"

#include <fstream>
#include <numeric>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "format/atlas_writer.h"
#include "format/codec/run_codec.h"
#include "format/codec/value_codec.h"
#include "format/derive/boundary_split.h"
#include "format/derive/run_fingerprint.h"
#include "format/derive/value_groups.h"
#include "format/io/checksum.h"
#include "tests/format/atlas_surgery.h"
#include "tests/format/random_content.h"
#include "tests/support/fails_with.h"
#include "tests/support/file_bytes.h"
#include "tests/support/message_of.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

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
  const auto atlas = Atlas::open_bytes(put_together(parts));
  ASSERT_TRUE(atlas) << atlas.error().message;
  EXPECT_THAT((*atlas)->read_values(kEmptyClass),
              FailsWith(ErrorCode::kLimit, HasSubstr("(memory): takes 8388608 MiB of memory at once")));
  EXPECT_THAT((*atlas)->verify(), FailsWith(ErrorCode::kInvalidAtlas, HasSubstr("damaged: 1 bytes")));
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
  const auto atlas = Atlas::open_bytes(put_together(parts));
  ASSERT_TRUE(atlas) << atlas.error().message;
  EXPECT_THAT(
      (*atlas)->read_runs(cube, Axis::kX),
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

struct AtlasFileTest : ::testing::Test {
  TemporaryFolder folder;
  std::filesystem::path path = folder.path() / "a.atlas";
  AtlasContent content = random_content(10, {30, 6, 300});
};

/// 2^32 voxels. The values of the empty class are a hole of 4 GiB in the file, followed by those of a class
/// of five voxels at the end of the grid.
TEST_F(AtlasFileTest, ReadsVoxelsPastFourGibibytes) {
  AtlasParts parts;
  Directory& directory = parts.directory;
  directory.source_grid.size = {1 << 16, 1 << 16, 1};
  directory.value_type = VoxelType::kUInt8;
  directory.graph = *StructureGraph::build({{"end", "", {}, {}, {}, false}});
  const ClassId end = directory.classes.intern({{0, Part::kInterior}});
  const std::uint64_t empty_voxels = (std::uint64_t{1} << 32) - 5;
  directory.classes.count(kEmptyClass, empty_voxels, {});
  directory.classes.count(end, 5, {{65531, 65535, 0}, {65535, 65535, 0}});
  directory.run_totals = {5, 1, 1};
  directory.surfaces.resize(1);
  directory.normals_fitted.resize(2);

  const ClassRuns runs{{65535, 65531, 5}};
  const RunFingerprinter fingerprinter(directory.source_grid.size);
  const VoxelSetFingerprint of_end = fingerprinter.of(runs, Axis::kZ);
  directory.fingerprints = {subtract_fingerprints(fingerprinter.of_grid(), of_end), of_end};
  Bytes run_list;
  append_run_list(runs, run_list);
  directory.run_bytes = {{}, {0, 0, static_cast<std::uint32_t>(run_list.size())}};
  const Bytes zeros(262'144), values{std::byte{1}, std::byte{2}, std::byte{3}, std::byte{4}, std::byte{5}};
  const std::vector<ClassSpan> spans{{runs[0], end}};
  const Bytes code =
      encode_values({spans, 5, directory.classes.box(end), 1 << 16}, VoxelType::kUInt8, values);
  const auto add_chunk = [&](const Bytes& bytes) {
    directory.chunks.push_back(
        {checksum_of(bytes), static_cast<std::uint32_t>(bytes.size()), ChunkCodec::kStored, 0});
  };
  add_chunk(run_list);
  for (int n = 0; n < 16383; ++n) add_chunk(zeros);
  add_chunk(Bytes(zeros.begin(), zeros.end() - 5));
  add_chunk(code);
  directory.sections = {{3, 1, 262'144, 4}, {4, 16385, 262'144, 4}, {5, 0, 262'144, 4}, {6, 0, 262'144, 4}};

  Bytes start = encode_directory(directory).value();
  const std::uint64_t file_bytes =
      sizeof(FileHeader) + start.size() + run_list.size() + empty_voxels + code.size();
  const FileHeader header = make_header(start, file_bytes);
  {
    std::ofstream file(path, std::ios::binary);
    const auto put = [&](const void* bytes, std::size_t size) {
      file.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(size));
    };
    put(&header, sizeof header);
    put(start.data(), start.size());
    put(run_list.data(), run_list.size());
    file.seekp(static_cast<std::streamoff>(file_bytes - code.size()));
    put(code.data(), code.size());
  }
  const auto atlas = Atlas::open(path).value();
  EXPECT_EQ(atlas->classes().voxels(kEmptyClass), empty_voxels);
  EXPECT_EQ(atlas->read_runs(end, Axis::kZ).value(), runs);
  EXPECT_EQ(atlas->read_runs(end, Axis::kX)->size(), 5u);
  EXPECT_EQ(atlas->read_values(end).value(), values);
  EXPECT_EQ(atlas->counters().file, file_bytes);
  EXPECT_EQ(atlas->counters().read, sizeof(FileHeader) + start.size() + run_list.size() + code.size());
  EXPECT_EQ(atlas->sections()[3].bytes, empty_voxels + code.size());
}

TEST_F(AtlasFileTest, ErrorsNameTheFile) {
  EXPECT_EQ(Atlas::open(path).error().code, ErrorCode::kFailed);
  EXPECT_EQ(Atlas::open(path).error().message,
            path.string() + ": cannot be opened: No such file or directory");
  write_bytes(path, "");
  EXPECT_EQ(Atlas::open(path).error().code, ErrorCode::kInvalidAtlas);
  EXPECT_EQ(Atlas::open(path).error().message, path.string() + ": not an atlas (its size is 0 bytes)");
  EXPECT_EQ(Atlas::open(folder.path()).error().code, ErrorCode::kInvalidAtlas);
}

TEST_F(AtlasFileTest, AFileTruncatedWhileOpenIsAnError) {
  ASSERT_TRUE(write_atlas(content, path, {.level = 1}));
  const auto atlas = Atlas::open(path).value();
  std::filesystem::resize_file(path, sizeof(FileHeader));
  EXPECT_THAT(message_of(atlas->verify()), HasSubstr(path.string() + ": truncated while open"));
  EXPECT_EQ(atlas->verify().error().code, ErrorCode::kInvalidAtlas);
  EXPECT_EQ(atlas->graph().size(), content.graph.size());
}

TEST_F(AtlasFileTest, AFileOverwrittenWhileOpenIsAnError) {
  ASSERT_TRUE(write_atlas(content, path, {.level = 1}));
  const auto atlas = Atlas::open(path).value();
  write_bytes(path, Bytes(std::filesystem::file_size(path), std::byte{0x5a}));
  EXPECT_THAT(message_of(atlas->verify()), HasSubstr("damaged: checksum of"));
}

TEST_F(AtlasFileTest, AFileReplacedWhileOpenStaysTheOldOne) {
  ASSERT_TRUE(write_atlas(content, path, {.level = 1}));
  const auto atlas = Atlas::open(path).value();
  ASSERT_TRUE(write_atlas(random_content(99), path, {.level = 1}));
  EXPECT_EQ(difference(content, atlas->read_all().value()), "");
}

}  // namespace
}  // namespace splatlas
