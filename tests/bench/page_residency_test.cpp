#include "tests/support/page_residency.h"

#include <fstream>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

constexpr std::size_t kPage = 4096;

TEST(PageResidency, CountsExactlyThePagesThatWereRead) {
  const TemporaryFolder folder(std::filesystem::current_path());
  const auto path = folder.path() / "pages";
  std::ofstream(path) << std::string(10 * kPage + 7, 'x');
  if (const Result<void> evicted = evict(path); !evicted) {
    // File system in memory: the bench must report it.
    EXPECT_NE(evicted.error().message.find("stay in memory"), std::string::npos);
    EXPECT_EQ(*resident_bytes(path), 10 * kPage + 7);
    return;
  }
  EXPECT_EQ(*resident_bytes(path), 0u);
  const int file = ::open(path.c_str(), O_RDONLY);
  ASSERT_GE(file, 0);
  ASSERT_EQ(::posix_fadvise(file, 0, 0, POSIX_FADV_RANDOM), 0);  // no read-ahead
  std::vector<char> bytes(2);
  ASSERT_EQ(::pread(file, bytes.data(), 2, 3 * kPage - 1), 2);  // pages 2 and 3
  EXPECT_EQ(*resident_bytes(path), 2 * kPage);
  ASSERT_EQ(::pread(file, bytes.data(), 1, 10 * kPage + 6), 1);  // the last page, of 7 bytes
  EXPECT_EQ(*resident_bytes(path), 2 * kPage + 7);
  ::close(file);
  ASSERT_TRUE(evict(path).has_value());
  EXPECT_EQ(*resident_bytes(path), 0u);
}

TEST(PageResidency, NamesTheFileThatIsNotThere) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "none";
  EXPECT_EQ(resident_bytes(path).error().message.find(path.string()), 0u);
  EXPECT_EQ(evict(path).error().message.find(path.string()), 0u);
  std::ofstream(path).flush();
  EXPECT_EQ(*resident_bytes(path), 0u);  // an empty one
}

}  // namespace
}  // namespace splatlas
