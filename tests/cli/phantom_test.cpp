// The paper's tables 1 and 2, from NRRD files to counts, through the command line.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/cli/phantom_atlas.h"
#include "tests/phantom/two_spheres.h"
#include "tests/support/file_bytes.h"

namespace splatlas {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

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

TEST(Phantom, ItsGroupCountsEveryVoxelOnce) {
  const json info = phantom_info();
  std::uint64_t interior = 0, boundary = 0;
  for (const json& s : info["structures"]) {
    if (!s["parents"].empty()) continue;
    interior += s["voxels"]["interior"].get<std::uint64_t>();
    boundary += s["voxels"]["boundary"].get<std::uint64_t>();
  }
  EXPECT_EQ(interior, 3142u);
  EXPECT_EQ(boundary, 1904u);
  EXPECT_EQ(phantom::kVoxels - interior - boundary, phantom::kEmptyVoxels);
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

TEST(PhantomProgram, MakesNoFolderOfAnOption) {
  const TemporaryFolder folder;
  const ProgramResult help = run_program({SPLATLAS_PHANTOM, "--help"}, folder.path());
  EXPECT_EQ(help.status, 0);
  EXPECT_TRUE(help.out.starts_with("usage: splatlas-phantom FOLDER\n")) << help.out;
  for (const Words& words : {Words{"--hepl"}, {"-x"}, {""}, {}, {"one", "two"}})
    EXPECT_EQ(run_program(joined({SPLATLAS_PHANTOM}, words), folder.path()).status, 2);
  EXPECT_TRUE(folder.names().empty());
}

TEST(PhantomAtlasProgram, MakesNoFileOfAnOption) {
  const TemporaryFolder folder;
  for (const char* option : {"--help", "-h"}) {
    const ProgramResult help = run_program({SPLATLAS_PHANTOM_ATLAS, option}, folder.path());
    EXPECT_EQ(help.status, 0);
    EXPECT_THAT(help.out, HasSubstr("splatlas-phantom-atlas [OPTIONS] FILE [KIND]"));
  }
  for (const Words& words : {Words{"--hepl"}, {"-x"}, {""}, {}, {"a.atlas", "broken"}, {"a", "empty", "b"}})
    EXPECT_EQ(run_program(joined({SPLATLAS_PHANTOM_ATLAS}, words), folder.path()).status, 2);
  EXPECT_TRUE(folder.names().empty());
}

TEST(PhantomAtlasProgram, WritesEachKind) {
  const TemporaryFolder folder;
  for (const Words& words : {Words{"a"}, {"b", "whole"}, {"c", "damaged"}, {"d", "empty"}}) {
    EXPECT_EQ(run_program(joined({SPLATLAS_PHANTOM_ATLAS}, words), folder.path()).status, 0);
    EXPECT_EQ(run_player({"verify", words[0]}, folder.path()).status, words[0] == "c" ? 3 : 0);
  }
  EXPECT_EQ(read_bytes(folder.file("a")), read_bytes(folder.file("b")));
  const ProgramResult failed = run_program({SPLATLAS_PHANTOM_ATLAS, "nowhere/x"}, folder.path());
  EXPECT_EQ(failed.status, 1);
  EXPECT_THAT(failed.err, HasSubstr("nowhere"));
}

}  // namespace
}  // namespace splatlas
