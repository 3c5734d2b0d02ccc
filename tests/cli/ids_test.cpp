// Id images and depth maps of splatlas-player.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tests/cli/phantom_atlas.h"
#include "tests/cli/read_pixels.h"
#include "tests/support/fails_with.h"
#include "tests/support/file_bytes.h"

namespace splatlas {
namespace {

/// Id images of the phantom, in a folder.
class PlayerIds : public testing::Test {
 protected:
  [[nodiscard]] ProgramResult run(const Words& words) const {
    return run_player(joined({"render", phantom_atlas(), "--size", "40x30"}, words), folder_.path());
  }
  /// Numbers of an image of 16 bits.
  [[nodiscard]] std::vector<int> numbers(const std::string& name) const {
    std::vector<int> numbers;
    for (const float value : read_pixels(folder_.file(name)))
      numbers.push_back(static_cast<int>(std::lround(value * 65535)));
    return numbers;
  }
  [[nodiscard]] std::string bytes(const std::string& name) const { return read_bytes(folder_.file(name)); }

  TemporaryFolder folder_;
};

TEST_F(PlayerIds, AreWrittenBesideThePicture) {
  for (const std::string quality : {"draft", "normal", "high"}) {
    for (const std::string projection : {"parallel", "perspective"}) {
      for (const std::string select : {"*", "*:surface", "*:both(opacity=0.4)"}) {
        const Words view{"--quality", quality, "--projection", projection, "--select", select};
        ASSERT_EQ(run(joined(view, {"-o", "plain.png"})).status, 0);
        const ProgramResult result =
            run(joined(view, {"-o", "p.png", "--ids", "ids.png", "--stats", "s.json"}));
        ASSERT_EQ(result.status, 0) << result.err;
        EXPECT_THAT(result.err, IsEmpty());
        EXPECT_EQ(bytes("p.png"), bytes("plain.png"));
        const std::vector<int> found = numbers("ids.png");
        ASSERT_EQ(found.size(), 40u * 30u);
        EXPECT_EQ(found.front(), 0);
        const nlohmann::json ids = nlohmann::json::parse(bytes("s.json"))["ids"];
        EXPECT_FALSE(ids.empty());
        for (const int number : found) {
          EXPECT_TRUE(number == 0 || ids.contains(std::to_string(number))) << number;
        }
        for (const auto& [number, id] : ids.items())
          EXPECT_NE(std::ranges::find(found, std::stoi(number)), found.end()) << id;
      }
    }
  }
}

TEST_F(PlayerIds, AreEqualInBothFormats) {
  ASSERT_EQ(run({"-o", "p.png", "--ids", "ids.png"}).status, 0);
  const ProgramResult result = run({"-o", "p.png", "--ids", "ids.exr"});
  ASSERT_EQ(result.status, 0) << result.err;
  const std::vector<int> expected = numbers("ids.png");
  const std::vector<float> found = read_pixels(folder_.file("ids.exr"));  // integers scale to [0, 1]
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t n = 0; n < found.size(); ++n)
    EXPECT_EQ(std::llround(static_cast<double>(found[n]) * 4294967295.0), expected[n]);
}

TEST_F(PlayerIds, AreNotInStatisticsUnlessAskedFor) {
  ASSERT_EQ(run({"-o", "p.png", "--stats", "s.json"}).status, 0);
  EXPECT_FALSE(nlohmann::json::parse(bytes("s.json")).contains("ids"));
}

/// A surface alone covers each pixel or none: depths are finite where the picture is opaque. The surfaces
/// that are seen lie in front of the middle.
TEST_F(PlayerIds, StandBesideDepthsInMillimetres) {
  ASSERT_EQ(run({"-o", "plain.exr", "--select", "*:surface", "--quality", "draft"}).status, 0);
  const ProgramResult result =
      run({"-o", "p.exr", "--select", "*:surface", "--quality", "draft", "--depth", "d.exr"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(bytes("p.exr"), bytes("plain.exr"));
  const auto input = OIIO::ImageInput::open(folder_.file("d.exr"));
  ASSERT_TRUE(input);
  EXPECT_EQ(input->spec().channelnames, std::vector<std::string>{"Z"});
  EXPECT_EQ(input->spec().format, OIIO::TypeDesc::FLOAT);
  const std::vector<float> depths = read_pixels(folder_.file("d.exr"));
  const std::vector<float> colors = read_pixels(folder_.file("p.exr"));
  ASSERT_EQ(depths.size(), 40u * 30u);
  std::size_t covered = 0;
  float sum = 0;
  for (std::size_t n = 0; n < depths.size(); ++n) {
    EXPECT_EQ(!std::isnan(depths[n]), colors[4 * n + 3] >= 0.5f) << n;
    if (std::isnan(depths[n])) continue;
    ++covered;
    sum += depths[n];
    EXPECT_LT(std::abs(depths[n]), 40) << n;
  }
  EXPECT_GT(covered, 100u);
  EXPECT_GT(sum, 0);
}

}  // namespace
}  // namespace splatlas
