#include <gtest/gtest.h>

#include "preprocess/import/tables/text_file.h"
#include "tests/preprocess/raw_image_files.h"
#include "tests/support/run_program.h"

namespace splatlas {
namespace {

TEST(FileHash, IsSha256OfTheBytes) {
  const TemporaryFolder folder;
  write_bytes(folder.file("a"), "");
  EXPECT_EQ(hash_file(folder.file("a")).value(),
            "sha256:e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");  // FIPS 180-2
  write_bytes(folder.file("a"), "abc");
  EXPECT_EQ(hash_file(folder.file("a")).value(),
            "sha256:ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

}  // namespace
}  // namespace splatlas
