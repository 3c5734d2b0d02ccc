#include "bench/report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace splatlas
