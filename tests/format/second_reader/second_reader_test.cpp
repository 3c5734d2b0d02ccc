// Second reader against the library.
#include "tests/format/second_reader/second_reader.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "format/atlas_reader.h"
#include "format/atlas_writer.h"
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
    const auto file = encode_atlas(golden.content, {.compact = golden.compact}).value();
    EXPECT_EQ(difference(golden.content, file), "") << golden.name;
  }
}

RC_GTEST_PROP(SecondReader, ReadsRandomAtlases, ()) {
  auto random = *random_source();
  const AtlasContent content = random_content(random, {9, 6, 20});
  const auto file = encode_atlas(content, {.level = 1, .compact = random() % 2 == 0}).value();
  RC_ASSERT(difference(content, file) == "");
}

}  // namespace
}  // namespace splatlas
