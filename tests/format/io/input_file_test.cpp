#include "format/io/input_file.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/support/fails_with.h"
#include "tests/support/page_residency.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

/// Reads through a mapping, or with pread().
struct InputFileTest : ::testing::TestWithParam<bool> {
  TemporaryFolder folder;
  std::filesystem::path path = folder.path() / "file";

  [[nodiscard]] auto open() const { return InputFile::open(path, GetParam()); }
  void write(const std::string& text) { std::ofstream(path, std::ios::binary) << text; }
  static std::string read(const InputFile& file, std::uint64_t offset, std::size_t size) {
    std::string text(size, '?');
    const auto done = file.read(offset, std::as_writable_bytes(std::span(text)));
    return done ? text : "error: " + done.error().message;
  }
};

INSTANTIATE_TEST_SUITE_P(Access, InputFileTest, ::testing::Bool(),
                         [](const auto& info) { return info.param ? "Mapped" : "Positioned"; });

TEST_P(InputFileTest, ReadsRanges) {
  write("0123456789");
  InputFile file = open().value();
  EXPECT_EQ(file.is_mapped(), GetParam());
  EXPECT_EQ(file.size(), 10u);
  EXPECT_EQ(file.name(), path.string());
  EXPECT_EQ(read(file, 0, 10), "0123456789");
  EXPECT_EQ(read(file, 3, 4), "3456");
  EXPECT_EQ(read(file, 10, 0), "");
  EXPECT_THAT(read(file, 8, 3), HasSubstr("truncated"));
  EXPECT_THAT(read(file, 11, 0), HasSubstr("truncated"));
  EXPECT_THAT(read(file, ~std::uint64_t{0}, 2), HasSubstr("truncated"));
  const InputFile moved = std::move(file);
  EXPECT_EQ(read(moved, 9, 1), "9");
}

TEST_P(InputFileTest, ReadsBytesInMemoryAlike) {
  const InputFile file({std::byte{'a'}, std::byte{'b'}}, "name");
  EXPECT_EQ(file.name(), "name");
  EXPECT_EQ(read(file, 1, 1), "b");
  EXPECT_THAT(read(file, 1, 2), HasSubstr("truncated"));
}

TEST_P(InputFileTest, ReadsPastFourGibibytes) {
  write("begin");
  std::filesystem::resize_file(path, (std::uint64_t{5} << 30) + 1);  // sparse except for its ends
  std::fstream(path, std::ios::binary | std::ios::in | std::ios::out).seekp(std::int64_t{5} << 30) << "e";
  const InputFile file = open().value();
  EXPECT_EQ(file.size(), (std::uint64_t{5} << 30) + 1);
  EXPECT_EQ(read(file, std::uint64_t{5} << 30, 1), "e");
  EXPECT_EQ(read(file, std::uint64_t{1} << 32, 1), std::string(1, '\0'));
  EXPECT_EQ(read(file, 0, 5), "begin");
}

TEST_P(InputFileTest, MissingFilesAreNoAtlasFault) {
  EXPECT_THAT(open(),
              FailsWith(ErrorCode::kFailed, path.string() + ": cannot be opened: No such file or directory"));
}

TEST_P(InputFileTest, OpensRegularFilesOnly) {
  const auto refusal = [](const std::filesystem::path& p) {
    const auto file = InputFile::open(p, GetParam());
    EXPECT_EQ(file.error().code, ErrorCode::kInvalidAtlas);
    return file.error().message;
  };
  EXPECT_THAT(refusal(folder.path()), HasSubstr("not an atlas (a folder)"));
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  // Must not wait for a writer
  EXPECT_THAT(InputFile::open(path, GetParam()),
              FailsWith(ErrorCode::kFailed, path.string() + ": is a pipe; save the atlas to a file first"));
  EXPECT_THAT(refusal("/dev/zero"), HasSubstr("not an atlas (not a regular file)"));
}

TEST_P(InputFileTest, AFileThatBecomesShorterIsAnError) {
  write(std::string(100'000, 'x'));
  const InputFile file = open().value();
  std::filesystem::resize_file(path, 50'000);
  EXPECT_EQ(read(file, 49'999, 1), "x");
  EXPECT_THAT(read(file, 0, 100'000), HasSubstr("truncated while open: ends at 50000, had 100000 bytes"));
  EXPECT_THAT(read(file, 49'999, 2),
              HasSubstr("truncated while open: ends at 50000"));  // within its last page
  EXPECT_THAT(read(file, 90'000, 1), HasSubstr("truncated while open: ends at 50000"));
}

TEST_P(InputFileTest, EmptyFilesAreReadAlike) {
  write("");
  const InputFile file = open().value();
  EXPECT_EQ(file.size(), 0u);
  EXPECT_EQ(read(file, 0, 0), "");
  EXPECT_THAT(read(file, 0, 1), HasSubstr("truncated"));
}

TEST_P(InputFileTest, ReadsThePagesOfARangeOnly) {
  const TemporaryFolder on_disk(std::filesystem::current_path());
  path = on_disk.path() / "file";
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  write(std::string(2048 * page, 'x'));
  if (const Result<void> evicted = evict(path); !evicted) GTEST_SKIP() << evicted.error().message;
  const InputFile file = open().value();
  EXPECT_EQ(read(file, 700 * page + 100, 1), "x");
  EXPECT_EQ(*resident_bytes(path), page);
  EXPECT_EQ(read(file, 1000 * page - 1, 20 * page), std::string(20 * page, 'x'));
  EXPECT_EQ(*resident_bytes(path), (1 + 21) * page);
}

TEST_P(InputFileTest, AFileThatIsReplacedStaysTheOldOne) {
  write("old");
  const InputFile file = open().value();
  std::filesystem::rename(path, folder.path() / "aside");
  write("new");
  EXPECT_EQ(read(file, 0, 3), "old");
}

}  // namespace
}  // namespace splatlas
