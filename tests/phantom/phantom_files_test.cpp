#include "tests/phantom/phantom_files.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/phantom/two_spheres.h"

namespace splatlas::phantom {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string read_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

class PhantomFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::remove_all(folder_);
    ASSERT_TRUE(std::filesystem::create_directory(folder_));
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  const std::filesystem::path folder_ =
      std::filesystem::path(::testing::TempDir()) /
      (std::string("splatlas_phantom_") + ::testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(PhantomFiles, AreRawNrrdOfTheClosedForm) {
  ASSERT_TRUE(write_files(folder_ / "new"));
  const std::pair<const char*, std::vector<std::uint8_t>> expected[] = {{"labels.nrrd", labels()},
                                                                        {"volume.nrrd", values()}};
  for (const auto& [name, voxels] : expected) {
    const std::string bytes = read_file(folder_ / "new" / name);
    EXPECT_THAT(bytes, StartsWith("NRRD0004\ntype: uint8\n")) << name;
    EXPECT_THAT(bytes, HasSubstr("sizes: 32 32 32\n")) << name;
    const auto header = bytes.find("\n\n");
    ASSERT_NE(header, std::string::npos) << name;
    EXPECT_EQ(bytes.substr(header + 2), std::string(voxels.begin(), voxels.end())) << name;
  }
}

TEST_F(PhantomFiles, NameEveryBallAndPlaceItInTheTree) {
  ASSERT_TRUE(write_files(folder_));
  for (const Ball& ball : kBalls) {
    const std::string name(ball.name);
    EXPECT_THAT(read_file(folder_ / "names.txt"),
                HasSubstr(std::to_string(ball.label) + " \"" + name + "\"\n"));
    EXPECT_THAT(read_file(folder_ / "phantom.tree"), HasSubstr("Phantom/" + name + " "));
  }
}

TEST_F(PhantomFiles, TellWhichFileCannotBeWritten) {
  std::ofstream(folder_ / "taken") << "a file, not a folder";
  const auto written = write_files(folder_ / "taken");
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, ErrorCode::kFailed);
  EXPECT_THAT(written.error().message, HasSubstr("taken"));
}

}  // namespace
}  // namespace splatlas::phantom
