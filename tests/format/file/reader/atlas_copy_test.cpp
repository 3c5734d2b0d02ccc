// Copies of atlases with other scenes.
#include <gmock/gmock.h>

#include "format/atlas_reader.h"
#include "tests/format/bad_files/raw_atlas.h"
#include "tests/support/fails_with.h"

namespace splatlas {
namespace {

Result<Bytes> copy_of(const Bytes& file, const std::vector<Scene>& scenes) {
  const auto atlas = Atlas::open_bytes(file, "F");
  if (!atlas) return tl::unexpected(atlas.error());
  Bytes copy;
  const auto copied =
      (*atlas)->copy_with_scenes(scenes, [&](std::span<const std::byte> bytes) -> Result<void> {
        copy.insert(copy.end(), bytes.begin(), bytes.end());
        return {};
      });
  if (!copied) return tl::unexpected(copied.error());
  return copy;
}

/// A file of a newer minor version, with a section of an unknown kind between the others.
RawAtlas newer_atlas() {
  RawAtlas atlas = raw_atlas(good_file());
  RawDirectory& d = atlas.directory;
  const std::size_t first = d.sections[0].chunks;
  d.sections.insert(d.sections.begin() + 1, RawSection{99, 1, 3, 5});
  d.chunks.insert(d.chunks.begin() + static_cast<std::ptrdiff_t>(first), RawChunk{0, 4, 7, 9, 0});
  const Bytes stored{std::byte{'n'}, std::byte{'e'}, std::byte{'w'}, std::byte{0}};
  d.chunks[first].checksum = checksum_of(stored);
  atlas.chunks.insert(atlas.chunks.begin() + static_cast<std::ptrdiff_t>(first), stored);
  atlas.on_header = [](FileHeader& header) { header.minor = 7, header.optional_features = 5; };
  return atlas;
}

TEST(AtlasCopy, ChangesScenesAlone) {
  const std::vector<Scene> scenes{
      {"New", "Two\nlines", "rest", 1, 2, 3, "Why?", "left=1", "#1", true, {"core"}},
      {"Other", "", "core", 0, 90, 1}};
  const Bytes file = file_of(newer_atlas());
  const Bytes copy = value_or_throw(copy_of(file, scenes));
  const auto atlas = value_or_throw(Atlas::open_bytes(copy));
  EXPECT_EQ(atlas->scenes(), scenes);
  const Result<void> valid = atlas->verify();
  EXPECT_TRUE(valid) << valid.error().message;

  EXPECT_EQ(take_apart(copy).chunks, take_apart(file).chunks);
  EXPECT_EQ(header_of(copy).minor, 7);
  EXPECT_EQ(header_of(copy).optional_features, 5u);
  const Bytes back = value_or_throw(copy_of(copy, (*Atlas::open_bytes(file))->scenes()));
  const Result<Bytes> same = copy_of(file, (*Atlas::open_bytes(file))->scenes());
  EXPECT_TRUE(back == *same) << "the rest of the directory is kept";
  EXPECT_TRUE(copy_of(good_file(), (*Atlas::open_bytes(good_file()))->scenes()) == good_file());
}

TEST(AtlasCopy, RefusesWhatItCannotCopy) {
  const std::vector<Scene> scenes{{"A", "", "*", 0, 0, 1}};
  RawAtlas newer = newer_atlas();
  newer.directory.scene_view_ends = {0, 1};  // the last field that this version knows
  newer.directory.scene_view_text = {'a'};
  newer.on_directory = [](Bytes& bytes) {  // a field more in the vtable
    const auto table = std::to_integer<std::size_t>(bytes[0]) + 256 * std::to_integer<std::size_t>(bytes[1]);
    std::int32_t to_vtable = 0;
    std::memcpy(&to_vtable, &bytes[table], sizeof to_vtable);
    std::byte& length = bytes[table - static_cast<std::size_t>(to_vtable)];
    length = std::byte(std::to_integer<int>(length) + 2);
  };
  EXPECT_THAT(copy_of(file_of(newer), scenes),
              FailsWith(ErrorCode::kFailed, HasSubstr("F: format 1.7 has entries in the directory")));
  RawAtlas damaged = newer_atlas();
  damaged.on_file = [](Bytes& file) { file.back() ^= std::byte{1}; };
  EXPECT_THAT(copy_of(file_of(damaged), scenes),
              FailsWith(ErrorCode::kInvalidAtlas, HasSubstr("F: damaged: checksum of ")));
  EXPECT_THAT(
      copy_of(good_file(), {{"A", "\a", "*", 0, 0, 1}}),
      FailsWith(ErrorCode::kFailed, HasSubstr("F: invalid: text of scene 0 has a control character")));
  EXPECT_THAT((*Atlas::open_bytes(good_file()))
                  ->copy_with_scenes(scenes, [](auto) { return fail(ErrorCode::kLimit, "full"); }),
              FailsWith(ErrorCode::kLimit, "full"));
}

}  // namespace
}  // namespace splatlas
