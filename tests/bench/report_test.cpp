#include "bench/report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace splatlas {
namespace {

using ::testing::HasSubstr;

TEST(Table, AlignsWordsToTheLeftAndNumbersToTheRight) {
  const Table table{"",
                    "A table",
                    {"a note"},
                    {{{"name", "a"}, {"count", 12345}, {"ms", 0.12345}},
                     {{"name", "longer"}, {"count", 7}, {"ms", 12.3456}}}};
  EXPECT_EQ(to_text(table),
            "A table\n"
            "  name    count     ms\n"
            "  a       12345  0.123\n"
            "  longer      7  12.35\n"
            "  a note\n");
}

TEST(Table, LeavesOutNothingThatOnlySomeRowsHave) {
  const Table table{"", "Gaps", {}, {{{"a", 1}}, {{"a", nullptr}, {"b", 200.04}}, {{"b", 1234.5}}}};
  EXPECT_EQ(to_text(table),
            "Gaps\n"
            "  a      b\n"
            "  1      -\n"
            "  -  200.0\n"
            "  -   1234\n");
}

Report small_report() {
  Report report;
  report.tables.push_back({"1", "First", {}, {{{"n", 1}}, {{"n", 2}}}});
  report.tables.push_back({"2", "Second", {}, {{{"m", 0.5}}}});
  report.summary["best"] = 0.25;
  return report;
}

TEST(Report, HasTheDocumentedFormInJson) {
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
