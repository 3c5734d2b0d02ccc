// Atlas of more than 2^32 voxels and 4 GiB, nearly all a hole: 32-bit counts of voxels or bytes fail.

#include <algorithm>
#include <fstream>
#include <utility>

#include <gtest/gtest.h>

#include "format/atlas_writer.h"
#include "format/codec/run_codec.h"
#include "format/io/checksum.h"
#include "player/renderer.h"
#include "tests/format/atlas_surgery.h"
#include "tests/reference/picture_difference.h"
#include "tests/support/fit_parts.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_content.h"

namespace splatlas {
namespace {

constexpr Index3 kLarge{2000, 2100, 1100};
static_assert(kLarge[0] * kLarge[1] * kLarge[2] > std::int64_t{1} << 32);
/// Place of the small grid in the large one: its voxels follow the 2^32nd.
constexpr Index3 kShift{1985, 2085, 1085};
constexpr std::uint32_t kHoleChunk = 1u << 24;

/// A box in 12^3 voxels with grey values, at its LPS position in the large grid.
AtlasContent content_of_box() {
  TestVolume volume;
  volume.grid.size = {12, 12, 12};
  for (std::size_t a = 0; a < 3; ++a) volume.grid.origin_lps_mm[a] = static_cast<double>(kShift[a]);
  volume.structures = {{"box", box_mask(volume.grid.size, {3, 2, 4}, {8, 8, 9})}};
  std::vector<std::uint8_t> greys;
  for (std::int64_t v = 0; v < volume.grid.voxels(); ++v) greys.push_back(static_cast<std::uint8_t>(v % 251));
  volume.values = make_values(VoxelType::kUInt8, greys);
  volume.window_high = 255;
  AtlasContent content = make_content(volume);
  fit_parts(content, 0);
  return content;
}

/// The same classes at another place, in another grid.
ClassTable shifted(const ClassTable& classes, std::uint64_t voxels) {
  ClassTable result;
  std::uint64_t held = 0;
  for (ClassId c = 1; c < classes.size(); ++c) {
    IndexBox box = classes.box(c);
    for (std::size_t a = 0; a < 3; ++a) {
      box.first[a] += kShift[a];
      box.last[a] += kShift[a];
    }
    const auto members = classes.members(c);
    result.count(result.intern({members.begin(), members.end()}), classes.voxels(c), box);
    held += classes.voxels(c);
  }
  result.count(kEmptyClass, voxels - held, {});
  return result;
}

ClassRuns shifted(ClassRuns runs, const Index3& size, Axis axis) {
  const ScanOrder order = ScanOrder::of(axis);
  const auto rows = static_cast<std::uint64_t>(size[order.row_axis]);
  const auto shift = [](std::uint8_t a) { return static_cast<std::uint64_t>(kShift[a]); };
  for (Run& run : runs) {
    const std::uint64_t slice = run.scanline / rows + shift(order.slice_axis);
    run.scanline = slice * static_cast<std::uint64_t>(kLarge[order.row_axis]) + run.scanline % rows +
                   shift(order.row_axis);
    run.start += static_cast<std::uint32_t>(shift(order.scan_axis));
  }
  return runs;
}

/// Embeds the small atlas in the large grid. Values come first, and all other sections follow the hole.
class LargeFile {
 public:
  LargeFile(const Bytes& small_file, const std::filesystem::path& path)
      : small_(take_apart(small_file)), atlas_(Atlas::open_bytes(small_file).value()) {
    directory_ = small_.directory;
    directory_.source_grid.size = kLarge;
    directory_.source_grid.origin_lps_mm = {0, 0, 0};
    directory_.classes =
        shifted(small_.directory.classes, static_cast<std::uint64_t>(directory_.source_grid.voxels()));
    directory_.sections.clear();
    directory_.chunks.clear();
    add_values();
    for (const Axis axis : kAxes) add_runs(axis);
    for (const SectionKind kind : {SectionKind::kNormals, SectionKind::kSurfaces}) {
      Bytes decoded;
      for (const Bytes& stream : decode_streams(small_, kind))
        decoded.insert(decoded.end(), stream.begin(), stream.end());
      add_section(kind, decoded, 4096);
    }
    write(path);
  }

 private:
  void add_runs(Axis axis) {
    Bytes decoded;
    const RunFingerprinter fingerprinter(kLarge);
    directory_.fingerprints[kEmptyClass] = fingerprinter.of_grid();
    for (ClassId c = 1; c < directory_.classes.size(); ++c) {
      const std::size_t begin = decoded.size();
      const ClassRuns runs = shifted(atlas_->read_runs(c, axis).value(), atlas_->grid().size, axis);
      append_run_list(runs, decoded);
      directory_.fingerprints[c] = fingerprinter.of(runs, axis);
      directory_.fingerprints[kEmptyClass] =
          subtract_fingerprints(directory_.fingerprints[kEmptyClass], directory_.fingerprints[c]);
      directory_.run_bytes[c][static_cast<std::size_t>(axis)] =
          static_cast<std::uint32_t>(decoded.size() - begin);
    }
    add_section(run_section(axis), decoded, 4096);
  }

  /// Values of the empty class: uncompressed chunks of zeros.
  void add_values() {
    const Bytes hole(kHoleChunk);
    const std::uint64_t checksum_of_hole = checksum_of(hole);
    const Bytes values = decode_streams(small_, SectionKind::kValues)[1];
    const std::vector<std::uint64_t> begins = begins_of(stream_sizes(directory_, SectionKind::kValues));
    const auto cuts = cut_streams(begins, kHoleChunk, 0, ~0u).value();
    for (std::size_t n = 0; n + 1 < cuts.size(); ++n) {
      const std::uint64_t bytes = cuts[n + 1] - cuts[n];
      const bool is_hole = cuts[n] < begins[1];
      const std::uint64_t checksum = !is_hole              ? checksum_of(values)
                                     : bytes == kHoleChunk ? checksum_of_hole
                                                           : checksum_of(std::span(hole).first(bytes));
      directory_.chunks.push_back({checksum, static_cast<std::uint32_t>(bytes), ChunkCodec::kStored, 0});
      stored_.push_back(is_hole ? Bytes{} : values);
    }
    directory_.sections.push_back({static_cast<std::uint32_t>(SectionKind::kValues),
                                   static_cast<std::uint32_t>(cuts.size() - 1), kHoleChunk, 0});
  }

  void add_section(SectionKind kind, const Bytes& decoded, std::uint32_t chunk_bytes) {
    const auto cuts = cut_streams(begins_of(stream_sizes(directory_, kind)), chunk_bytes, 512, ~0u).value();
    for (std::size_t n = 0; n + 1 < cuts.size(); ++n) {
      const EncodedChunk chunk = encode_chunk(std::span(decoded).subspan(cuts[n], cuts[n + 1] - cuts[n]), 3);
      directory_.chunks.push_back(chunk.entry);
      stored_.push_back(chunk.bytes);
    }
    directory_.sections.push_back(
        {static_cast<std::uint32_t>(kind), static_cast<std::uint32_t>(cuts.size() - 1), chunk_bytes, 512});
  }

  void write(const std::filesystem::path& path) const {
    const Bytes directory = encode_directory(directory_).value();
    const FileLayout layout = lay_out(directory_, directory.size()).value();
    const FileHeader header = make_header(directory, layout.file_bytes());
    std::ofstream file(path, std::ios::binary);
    const auto put = [&](std::uint64_t offset, const void* bytes, std::size_t size) {
      file.seekp(static_cast<std::streamoff>(offset));
      file.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(size));
    };
    put(0, &header, sizeof header);
    put(sizeof header, directory.data(), directory.size());
    for (std::size_t n = 0; n < stored_.size(); ++n)
      put(layout.chunk_offset[n], stored_[n].data(), stored_[n].size());
  }

  AtlasParts small_;
  std::shared_ptr<const Atlas> atlas_;
  Directory directory_;
  std::vector<Bytes> stored_;  // empty: a hole
};

struct LargeAtlas : ::testing::Test {
  TemporaryFolder folder;
  Bytes small_file = encode_atlas(content_of_box()).value();
  std::filesystem::path path = folder.path() / "large.atlas";

  LargeAtlas() { LargeFile(small_file, path); }
};

TEST_F(LargeAtlas, ReadsWhatLiesBehindTheHole) {
  const auto large = Atlas::open(path).value();
  const auto small = Atlas::open_bytes(small_file).value();
  EXPECT_GT(large->counters().file, std::uint64_t{1} << 32);
  EXPECT_EQ(large->classes().voxels(kEmptyClass), 2000ull * 2100 * 1100 - 6 * 7 * 6);
  for (ClassId c = 1; c < small->classes().size(); ++c) {
    for (const Axis axis : kAxes) {
      EXPECT_EQ(large->read_runs(c, axis).value(),
                shifted(small->read_runs(c, axis).value(), small->grid().size, axis));
    }
    EXPECT_EQ(large->read_values(c).value(), small->read_values(c).value());
    EXPECT_EQ(large->read_normals(c).value(), small->read_normals(c).value());
  }
  const SurfaceMesh surface = large->read_surface(0).value(), expected = small->read_surface(0).value();
  EXPECT_EQ(surface.triangles, expected.triangles);
  ASSERT_EQ(surface.positions_ijk.size(), expected.positions_ijk.size());
  for (std::size_t v = 0; v < surface.positions_ijk.size(); ++v) {
    for (std::size_t a = 0; a < 3; ++a)
      EXPECT_EQ(surface.positions_ijk[v][a], expected.positions_ijk[v][a] + static_cast<float>(kShift[a]));
  }
  EXPECT_LT(large->counters().read, std::uint64_t{1} << 15);
}

TEST_F(LargeAtlas, RendersAsTheSmallOneDoes) {
  Renderer large(Atlas::open(path).value(), {.threads = 2});
  Renderer small(Atlas::open_bytes(small_file).value(), {.threads = 2});
  for (const char* text : {"box:surface", "box:volume", "box:both(opacity=0.5)"}) {
    for (const auto projection : {CameraProjection::kParallel, CameraProjection::kPerspective}) {
      for (const double azimuth : {0.0, 70.0}) {
        SCOPED_TRACE(text);
        const Camera camera{.azimuth_deg = azimuth, .elevation_deg = 10, .projection = projection};
        Frame of_large, of_small;
        for (auto [renderer, frame] : {std::pair(&large, &of_large), std::pair(&small, &of_small)}) {
          ASSERT_TRUE(renderer->select(selection_of(text, renderer->atlas().graph())));
          value_or_throw(renderer->render(camera, {.size = {40, 40}}, *frame));
        }
        // At 2000 voxels, single precision resolves 2^-13 voxels, and grey values jump between voxels.
        EXPECT_GT(std::ranges::max(of_small.picture.rgba), 0.2f);
        EXPECT_LT(reference::difference(of_large.picture, of_small.picture).largest, 0.005);
      }
    }
  }
  EXPECT_LT(large.atlas().counters().read, std::uint64_t{1} << 15);
}

}  // namespace
}  // namespace splatlas
