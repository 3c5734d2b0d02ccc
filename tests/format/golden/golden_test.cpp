// Golden files: readers of later versions must open files of this one.
#include <filesystem>

#include <gtest/gtest.h>

#include "format/atlas_reader.h"
#include "format/atlas_writer.h"
#include "tests/format/golden/golden_contents.h"
#include "tests/support/file_bytes.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

TEST(Golden, FilesHoldWhatTheyHeld) {
  std::size_t files = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(fs::path(SPLATLAS_GOLDEN) / "1.0")) {
    if (entry.path().extension() != ".atlas") continue;
    ++files;
    const auto atlas = Atlas::open(entry.path());
    ASSERT_TRUE(atlas) << atlas.error().message;
    EXPECT_EQ((*atlas)->format_version(), "1.0");
    const auto valid = (*atlas)->verify();
    EXPECT_TRUE(valid) << valid.error().message;
    const auto content = (*atlas)->read_all();
    ASSERT_TRUE(content) << content.error().message;
    EXPECT_EQ(content_text(*content), read_bytes(fs::path(entry.path()).replace_extension(".txt")))
        << entry.path();
  }
  EXPECT_EQ(files, golden_contents().size());
}

/// Current contents survive a round trip, so that golden files of this version can be written at any time.
TEST(Golden, ContentsComeBackAsTheyWere) {
  for (const GoldenContent& golden : golden_contents()) {
    const auto atlas = Atlas::open_bytes(encode_atlas(golden.content, {.compact = golden.compact}).value());
    ASSERT_TRUE(atlas) << golden.name << ": " << atlas.error().message;
    const auto valid = (*atlas)->verify();
    EXPECT_TRUE(valid) << golden.name << ": " << valid.error().message;
    EXPECT_EQ(content_text((*atlas)->read_all().value()), content_text(golden.content)) << golden.name;
  }
}

}  // namespace
}  // namespace splatlas
