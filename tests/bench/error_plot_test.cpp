#include "bench/error_plot.h"

#include <array>
#include <fstream>
#include <iterator>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/run_program.h"

namespace splatlas {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

Row row(const char* renderer, int size, int threads, double wall_ms, double rmse) {
  return {{"scene", "left"},    {"size", size},       {"transfer", "soft"}, {"renderer", renderer},
          {"threads", threads}, {"wall_ms", wall_ms}, {"rmse", rmse}};
}

std::array<Table, 2> tables() {
  return {Table{"parallel",
                "",
                {},
                {row("splatlas", 512, 2, 7, 0.5), row("splatlas", 512, 2, 3, 2),
                 row("splatlas", 512, 1, 5, 2), row("splatlas", 1024, 2, 99, 2)}},
          Table{"perspective", "", {}, {row("VTK GPU", 512, 2, 100, 0.7)}}};
}

TEST(ErrorPlot, HasACurvePerRendererFastestFirstAtTheSmallestSize) {
  const std::string script = error_plot_script(tables(), "a \"b\".png");
  EXPECT_THAT(script, HasSubstr("set output \"a \\\"b\\\".png\"\n"));
  EXPECT_THAT(script, HasSubstr("$curve0 << EOD\n3 2\n7 0.5\nEOD\n"));
  EXPECT_THAT(script, HasSubstr("$curve1 << EOD\n100 0.7\nEOD\n"));
  EXPECT_THAT(script, HasSubstr("title \"splatlas\""));
  EXPECT_THAT(script, HasSubstr("set title \"left, soft, 512x512\""));
  EXPECT_THAT(script, Not(HasSubstr("99")));
}

TEST(ErrorPlot, IsAPngOrNothing) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_error_plot(tables(), folder.file("plot.png")));
  std::ifstream file(folder.file("plot.png"), std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  EXPECT_EQ(bytes.substr(0, 4), "\x89PNG");
  EXPECT_FALSE(write_error_plot(tables(), folder.file("no/such/folder.png")));
  EXPECT_EQ(folder.names(), std::vector<std::string>{"plot.png"});
}

}  // namespace
}  // namespace splatlas
