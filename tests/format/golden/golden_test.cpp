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

/// What a golden file held. A text of values alone is that of the good atlas otherwise.
std::string expected_text(fs::path path) {
  const std::string text = read_bytes(path.replace_extension(".txt"));
  return text.starts_with("labels ") ? with_values_of(read_bytes(path.replace_filename("good.txt")), text)
                                     : text;
}

TEST(Golden, FilesHoldWhatTheyHeld) {
  std::size_t files = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(fs::path(SPLATLAS_GOLDEN) / "1.0")) {
    if (entry.path().extension() != ".atlas") continue;
    ++files;
    const auto atlas = value_or_throw(Atlas::open(entry.path()));
    EXPECT_EQ(atlas->format_version(), "1.0");
    const auto valid = atlas->verify();
    EXPECT_TRUE(valid) << valid.error().message;
    const auto content = value_or_throw(atlas->read_all());
    EXPECT_EQ(content_text(content), expected_text(entry.path())) << entry.path();
  }
  EXPECT_EQ(files, golden_contents().size());
}

/// Golden files of this version can be written at any time: contents survive, and texts say what they did.
TEST(Golden, ContentsComeBackAsTheyWere) {
  const std::string good = content_text(golden_contents().front().content);
  for (const GoldenContent& golden : golden_contents()) {
    const auto atlas = value_or_throw(Atlas::open_bytes(
        encode_atlas(golden.content, {.compact = golden.compact, .means_from = golden.means_from}).value()));
    const std::string text = content_text(golden.content);
    EXPECT_EQ(content_text(atlas->read_all().value()), text) << golden.name;
    const std::string name = golden.name + ".txt";
    EXPECT_EQ(golden.name == "good" ? text : text_beside(good, text),
              read_bytes(fs::path(SPLATLAS_GOLDEN) / "1.0" / name))
        << name;
  }
}

}  // namespace
}  // namespace splatlas
