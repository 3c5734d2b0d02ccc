// The paper's tables 1 and 2, from NRRD files to counts, through the command line.

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/cli/phantom_atlas.h"
#include "tests/phantom/two_spheres.h"
#include "tests/support/file_bytes.h"

namespace splatlas {
namespace {

using nlohmann::json;

json phantom_info() {
  const ProgramResult info = run_player({"info", phantom_atlas(), "--json"});
  EXPECT_EQ(info.status, 0) << info.err;
  return json::parse(info.out);
}

json structure(const json& info, const std::string& name) {
  for (const json& s : info["structures"]) {
    if (s["name"] == name) return s;
  }
  ADD_FAILURE() << "no structure " << name;
  return {};
}

TEST(Phantom, Table1ComesOutOfInfo) {
  const json info = phantom_info();
  for (std::size_t n = 0; n < phantom::kBalls.size(); ++n) {
    const json ball = structure(info, std::string(phantom::kBalls[n].name));
    EXPECT_EQ(ball["voxels"]["interior"], phantom::kTable1[n].interior);
    EXPECT_EQ(ball["voxels"]["boundary"], phantom::kTable1[n].boundary);
    EXPECT_EQ(ball["triangles"], phantom::kTable1[n].triangles);
  }
  EXPECT_EQ(info["grid"]["size"], json({32, 32, 32}));
  EXPECT_EQ(info["classes"], 5);  // empty, and interior and boundary of each ball
  EXPECT_EQ(info["axes"].size(), 3u);
}

TEST(Phantom, Table2ComesOutOfStats) {
  struct Row {
    const char* select;
    std::uint64_t volume, surface, hybrid;
  };
  for (const Row& row : {Row{"\"Sphere 1\":surface + \"Sphere 2\":surface", 0, 1904, 0},
                         {"\"Sphere 1\":volume + \"Sphere 2\":volume", 5046, 0, 0},
                         {"\"Sphere 1\":surface + \"Sphere 2\":both", 437, 1440, 464},
                         {"\"Sphere 1\":volume + \"Sphere 2\":surface", 4145, 464, 0}}) {
    SCOPED_TRACE(row.select);
    const TemporaryFolder folder;
    const ProgramResult render = run_player({"render", phantom_atlas(), "-o", "x.png", "--size", "64x64",
                                             "--select", row.select, "--stats", "stats.json"},
                                            folder.path());
    ASSERT_EQ(render.status, 0) << render.err;
    EXPECT_EQ(folder.names(), (Words{"stats.json", "x.png"}));
    const json stats = json::parse(read_bytes(folder.file("stats.json")));
    EXPECT_EQ(stats["voxels"]["volume"], row.volume);
    EXPECT_EQ(stats["voxels"]["surface"], row.surface);
    EXPECT_EQ(stats["voxels"]["hybrid"], row.hybrid);
    const double selected = static_cast<double>(row.volume + row.surface + row.hybrid);
    EXPECT_DOUBLE_EQ(stats["occupancy"].get<double>(), selected / 32768.0);
  }
}

}  // namespace
}  // namespace splatlas
