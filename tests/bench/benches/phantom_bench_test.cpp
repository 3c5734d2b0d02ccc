// splatlas-bench from the command line.

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/phantom/two_spheres.h"
#include "tests/support/run_program.h"

namespace splatlas {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

TEST(PhantomBench, CountsWhatThePapersTables1And2Count) {
  const TemporaryFolder folder;
  const ProgramResult bench =
      run_program({SPLATLAS_BENCH, "phantom", "--quick", "--json", "phantom.json"}, folder.path());
  ASSERT_EQ(bench.status, 0) << bench.err;
  EXPECT_THAT(bench.out, HasSubstr("Table 1"));
  EXPECT_THAT(bench.out, HasSubstr("Table 2"));
  std::ifstream file(folder.file("phantom.json"));
  const json report = json::parse(file);

  const json& summary = report["summary"];
  for (std::size_t ball = 0; ball < 2; ++ball) {
    const std::string number = std::to_string(ball + 1);
    EXPECT_EQ(summary["interior_" + number], phantom::kTable1[ball].interior);
    EXPECT_EQ(summary["boundary_" + number], phantom::kTable1[ball].boundary);
    EXPECT_EQ(summary["triangles_" + number], phantom::kTable1[ball].triangles);
  }
  EXPECT_EQ(summary["empty"], phantom::kEmptyVoxels);

  json table_2 = json::array();
  for (const json& row : report["rows"]) {
    if (row["table"] != "2") continue;
    table_2.push_back({row["figure"], row["k_vol"], row["k_sur"], row["k_hyb"], row["bits_differ"]});
    EXPECT_GT(row["cost_ratio"], 0);
  }
  EXPECT_EQ(table_2.dump(),
            R"([["4a",0,1904,0,0],["4b",5046,0,0,0],["4c",437,1440,464,0],["4d",4145,464,0,0]])");
}

}  // namespace
}  // namespace splatlas
