// Pictures and documents of splatlas-player.

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/cli/phantom_atlas.h"
#include "tests/cli/read_pixels.h"

namespace splatlas {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

std::string bytes_of_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void write_file(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

TEST(PlayerRender, WritesEveryFormat) {
  const TemporaryFolder folder;
  const std::vector<std::pair<std::string, std::string>> formats{
      {"a.png", "\x89PNG"}, {"a.jpg", "\xff\xd8"}, {"a.tif", ""}, {"a.exr", "\x76\x2f\x31\x01"}};
  for (const auto& [name, magic] : formats) {
    const ProgramResult result = run_program(
        {SPLATLAS_PLAYER, "render", phantom_atlas(), "-o", name, "--size", "40x30"}, folder.path());
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_THAT(result.err, IsEmpty());
    EXPECT_THAT(bytes_of_file(folder.file(name)), StartsWith(magic));
  }
  EXPECT_EQ(folder.names(), (std::vector<std::string>{"a.exr", "a.jpg", "a.png", "a.tif"}));
}

TEST(PlayerRender, InBothProjectionsAndClassifications) {
  const TemporaryFolder folder;
  std::vector<std::vector<float>> pictures;
  for (const std::string projection : {"parallel", "perspective"}) {
    for (const std::string classify : {"before", "after"}) {
      const ProgramResult result =
          run_program({SPLATLAS_PLAYER, "render", phantom_atlas(), "-o", "a.png", "--size", "40x30",
                       "--projection", projection, "--classify", classify, "--select", "*:volume"},
                      folder.path());
      ASSERT_EQ(result.status, 0) << result.err;
      pictures.push_back(read_pixels(folder.file("a.png")));
      const auto [min, max] = std::minmax_element(pictures.back().begin(), pictures.back().end());
      EXPECT_EQ(*min, 0);
      EXPECT_GT(*max, 0.2f);
      for (std::size_t n = 0; n + 1 < pictures.size(); ++n) EXPECT_NE(pictures[n], pictures.back());
    }
  }
}

TEST(PlayerRender, PngAndTiffHoldTheSamePixels) {
  const TemporaryFolder folder;
  for (const std::string background : {"#204060", "transparent"}) {
    for (const std::string name : {"a.png", "a.tif"}) {
      const ProgramResult result = run_program({SPLATLAS_PLAYER, "render", phantom_atlas(), "-o", name,
                                                "--size", "40x30", "--background", background},
                                               folder.path());
      ASSERT_EQ(result.status, 0) << result.err;
    }
    const std::vector<float> png = read_pixels(folder.file("a.png"));
    EXPECT_EQ(png.size(), std::size_t{40} * 30 * (background == "transparent" ? 4 : 3));
    EXPECT_EQ(png, read_pixels(folder.file("a.tif")));
  }
}

TEST(PlayerRender, PicturesDoNotDependOnThreads) {
  const TemporaryFolder folder;
  for (const std::string threads : {"1", "2", "8"}) {
    const ProgramResult result =
        run_program({SPLATLAS_PLAYER, "render", phantom_atlas(), "-o", threads + ".exr", "--threads", threads,
                     "--azimuth", "33", "--elevation", "21", "--select",
                     "\"Sphere 1\":both(opacity=0.4) + \"Sphere 2\":surface(opacity=0.5)"},
                    folder.path());
    ASSERT_EQ(result.status, 0) << result.err;
  }
  // Not EXPECT_EQ, which would print both files.
  EXPECT_TRUE(bytes_of_file(folder.file("1.exr")) == bytes_of_file(folder.file("2.exr")));
  EXPECT_TRUE(bytes_of_file(folder.file("1.exr")) == bytes_of_file(folder.file("8.exr")));
}

TEST(PlayerRender, TakesTransferFunctions) {
  const TemporaryFolder folder;
  const auto picture_of = [&](const std::string& options) {
    const ProgramResult result = run_program({SPLATLAS_PLAYER, "render", phantom_atlas(), "-o", "t.exr",
                                              "--select", "\"Sphere 1\"(" + options + ")"},
                                             folder.path());
    EXPECT_EQ(result.status, 0) << result.err;
    return bytes_of_file(folder.file("t.exr"));
  };
  const std::string ramp = picture_of("low=0,high=255,opacity=0.25");
  EXPECT_TRUE(ramp == picture_of("curve=0:0:0.25/255:0.25"));
  EXPECT_TRUE(ramp == picture_of("profile=thin,low=0,high=255,opacity=0.25"));
  EXPECT_FALSE(ramp == picture_of("profile=thin,low=0,high=255"));
  EXPECT_FALSE(ramp == picture_of("profile=hard,low=0,high=255,opacity=0.25"));
  EXPECT_FALSE(ramp == picture_of("curve=0:0/255:0.25"));
}

TEST(PlayerRender, AnEmptySelectionGivesTheBackground) {
  const TemporaryFolder folder;
  for (const std::string select : {"", "Sphere* - Sphere*"}) {
    const ProgramResult result =
        run_program({SPLATLAS_PLAYER, "render", phantom_atlas(), "-o", "e.png", "--select", select, "--size",
                     "40x30", "--background", "#204060", "--stats", "s.json"},
                    folder.path());
    ASSERT_EQ(result.status, 0) << result.err;
    const std::vector<float> pixels = read_pixels(folder.file("e.png"));
    ASSERT_EQ(pixels.size(), std::size_t{3} * 40 * 30);
    for (std::size_t n = 0; n < pixels.size(); ++n) {
      const std::array<float, 3> background{0x20 / 255.0f, 0x40 / 255.0f, 0x60 / 255.0f};
      ASSERT_NEAR(pixels[n], background[n % 3], 1e-6f) << "value " << n;
    }
    const auto stats = nlohmann::json::parse(bytes_of_file(folder.file("s.json")));
    EXPECT_EQ(stats["voxels_visited"], 0);
    EXPECT_EQ(stats["runs_visited"], 0);
    EXPECT_EQ(stats["bytes"]["decoded"], 0);
  }
}

TEST(PlayerRender, ReadsOnlyWhatIsSelected) {
  const TemporaryFolder folder;
  const auto stats_of = [&](const std::string& select) {
    const ProgramResult result = run_program(
        {SPLATLAS_PLAYER, "render", phantom_atlas(), "-o", "x.png", "--select", select, "--stats", "s.json"},
        folder.path());
    EXPECT_EQ(result.status, 0) << result.err;
    return nlohmann::json::parse(bytes_of_file(folder.file("s.json")));
  };
  const auto read = [](const nlohmann::json& stats) { return stats["bytes"]["read"].get<std::int64_t>(); };
  const auto none = stats_of("");
  const auto one = stats_of("\"Sphere 1\":volume");
  const auto two = stats_of("\"Sphere 2\":volume");
  const auto both = stats_of("\"Sphere 1\":volume + \"Sphere 2\":volume");
  // The header, the directory and, in a file this small, chunks are shared. Nothing is read twice.
  EXPECT_LT(read(none), read(two));
  EXPECT_LE(read(two), read(both));
  EXPECT_LE(read(both) - read(none), read(one) - read(none) + read(two) - read(none));
  // Only the selected balls are splatted, above the low end of the grey window.
  EXPECT_LE(one["voxels_visited"].get<int>(), 2705 + 1440);
  EXPECT_GT(one["voxels_visited"].get<int>(), 2705);
  EXPECT_LE(two["voxels_visited"].get<int>(), 437 + 464);
  EXPECT_EQ(one["voxels_visited"].get<int>() + two["voxels_visited"].get<int>(),
            both["voxels_visited"].get<int>());
  EXPECT_EQ(one["runs_visited"].get<int>() + two["runs_visited"].get<int>(), both["runs_visited"].get<int>());
}

TEST(PlayerRender, ATruncatedAtlasIsRefused) {
  const TemporaryFolder folder;
  const std::string whole = bytes_of_file(phantom_atlas());
  ASSERT_GT(whole.size(), 1000u);
  for (const std::size_t length :
       {std::size_t{0}, std::size_t{10}, std::size_t{64}, whole.size() / 2, whole.size() - 1}) {
    write_file(folder.file("cut.atlas"), whole.substr(0, length));
    for (const std::string command : {"render", "info", "verify"}) {
      std::vector<std::string> words{SPLATLAS_PLAYER, command, "cut.atlas"};
      if (command == "render") words.insert(words.end(), {"-o", "x.png"});
      const ProgramResult result = run_program(words, folder.path());
      EXPECT_EQ(result.status, 3) << command << " of " << length << " bytes: " << result.err;
      EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
      EXPECT_THAT(result.err, HasSubstr("cut.atlas: "));
    }
    EXPECT_EQ(folder.names(), std::vector<std::string>{"cut.atlas"});
  }
}

/// The last chunk holds Sphere 2's values.
TEST(PlayerRender, DamageCostsItsStructureAndIsNoSuccess) {
  const TemporaryFolder folder;
  std::string bytes = bytes_of_file(phantom_atlas());
  bytes.back() = static_cast<char>(bytes.back() ^ 1);
  write_file(folder.file("bad.atlas"), bytes);
  const auto render = [&](const std::string& atlas, const std::string& select) {
    return run_program({SPLATLAS_PLAYER, "render", atlas, "-o", "x.png", "--select", select, "--size",
                        "40x30", "--stats", "s.json"},
                       folder.path());
  };
  const ProgramResult damaged = render("bad.atlas", "*");
  EXPECT_EQ(damaged.status, 3);
  EXPECT_EQ(
      damaged.err,
      "splatlas-player: \"Sphere_2\": its volume of 901 voxels is missing: bad.atlas: damaged: checksum of "
      "values of classes 3 to 4\n"
      "splatlas-player: bad.atlas: damaged; x.png was written without what is missing\n");
  const nlohmann::json stats = nlohmann::json::parse(bytes_of_file(folder.file("s.json")));
  EXPECT_EQ(stats["missing"].size(), 1u);
  EXPECT_EQ(stats["missing"][0]["structure"], "Sphere_2");
  EXPECT_EQ(stats["missing"][0]["part"], "volume");
  EXPECT_EQ(stats["missing"][0]["voxels"], 901);
  const std::vector<float> rest = read_pixels(folder.file("x.png"));
  EXPECT_EQ(render(phantom_atlas(), "\"Sphere 1\"").status, 0);
  EXPECT_EQ(read_pixels(folder.file("x.png")), rest);

  // Sphere 2 alone leaves nothing to draw; the other structures are complete.
  std::filesystem::remove(folder.file("x.png"));
  EXPECT_EQ(render("bad.atlas", "\"Sphere 2\"").status, 3);
  EXPECT_FALSE(std::filesystem::exists(folder.file("x.png")));
  EXPECT_EQ(render("bad.atlas", "\"Sphere 1\" + \"Sphere 2\":surface").status, 0);
}

TEST(PlayerVerify, FindsADamagedByte) {
  const TemporaryFolder folder;
  std::string bytes = bytes_of_file(phantom_atlas());
  EXPECT_EQ(run_program({SPLATLAS_PLAYER, "verify", phantom_atlas()}).status, 0);
  bytes[bytes.size() - 3] = static_cast<char>(bytes[bytes.size() - 3] ^ 1);
  write_file(folder.file("bad.atlas"), bytes);
  const ProgramResult result = run_program({SPLATLAS_PLAYER, "verify", "bad.atlas"}, folder.path());
  EXPECT_EQ(result.status, 3);
  EXPECT_THAT(result.err, HasSubstr("bad.atlas: "));
}

TEST(PlayerInfo, TheTextListsEveryStructure) {
  const ProgramResult info = run_program({SPLATLAS_PLAYER, "info", phantom_atlas()});
  EXPECT_EQ(info.status, 0);
  EXPECT_THAT(info.out, HasSubstr("Sphere 1"));
  EXPECT_THAT(info.out, HasSubstr("32 x 32 x 32"));
}

}  // namespace
}  // namespace splatlas
