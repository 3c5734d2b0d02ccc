#include <gtest/gtest.h>

#include "preprocess/import/tables/text_file.h"
#include "tests/preprocess/raw_image_files.h"
#include "tests/support/run_program.h"

namespace splatlas {
namespace {

TEST(FileHash, IsXxh64OfTheBytes) {
  const TemporaryFolder folder;
  write_bytes(folder.file("a"), "");
  EXPECT_EQ(hash_file(folder.file("a")).value(), "xxh64:ef46db3751d8e999");  // xxHash's own test vector
  write_bytes(folder.file("a"), "abc");
  EXPECT_EQ(hash_file(folder.file("a")).value(), "xxh64:44bc2cf5ad770999");
  EXPECT_FALSE(hash_file(folder.file("missing")));
}

}  // namespace
}  // namespace splatlas
