#include "bench/report.h"

#include <filesystem>
#include <fstream>
#include <iterator>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/run_program.h"

namespace splatlas {
namespace {

using ::testing::HasSubstr;

Report small_report() {
  Report report;
  report.tables.push_back({"1", "First", {}, {{{"n", 1}}, {{"n", 2}}}});
  report.tables.push_back({"2", "Second", {}, {{{"m", 0.5}}}});
  report.summary["best"] = 0.25;
  return report;
}

std::string read_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(Report, HasTheContractsFormInJson) {
  const auto json = nlohmann::ordered_json::parse(report_json("phantom", small_report()));
  EXPECT_EQ(json["bench"], "phantom");
  EXPECT_EQ(json["rows"].dump(), R"([{"table":"1","n":1},{"table":"1","n":2},{"table":"2","m":0.5}])");
  EXPECT_EQ(json["summary"].dump(), R"({"best":0.25})");
  for (const char* key : {"cpu", "cores", "simd", "compiler", "build_type", "date"}) {
    EXPECT_TRUE(json["machine"].contains(key)) << key;
  }
}

TEST(Report, ShowsTablesSummaryAndMachineAsText) {
  const std::string text = report_text(small_report());
  EXPECT_THAT(text, HasSubstr("First\n  n\n  1\n  2\n"));
  EXPECT_THAT(text, HasSubstr("Second\n"));
  EXPECT_THAT(text, HasSubstr("best"));
  EXPECT_THAT(text, HasSubstr("simd"));
}

TEST(Report, IsWrittenWholeOrNotAtAll) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_report(folder.path() / "a.json", "{}\n"));
  EXPECT_EQ(read_file(folder.path() / "a.json"), "{}\n");

  std::filesystem::create_directory(folder.path() / "taken");
  std::ofstream(folder.path() / "taken/file") << "so that the folder cannot be replaced";
  for (const char* name : {"taken", "missing/a.json"}) {
    const auto written = write_report(folder.path() / name, "{}\n");
    ASSERT_FALSE(written) << name;
    EXPECT_THAT(written.error().message, HasSubstr(name));
  }
  EXPECT_EQ(folder.names(), (std::vector<std::string>{"a.json", "taken"}));
}

}  // namespace
}  // namespace splatlas
