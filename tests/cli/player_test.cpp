// Pictures, documents and other output files of splatlas-player: complete or absent, never over an input.

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tests/cli/phantom_atlas.h"
#include "tests/cli/read_pixels.h"
#include "tests/support/fails_with.h"
#include "tests/support/file_bytes.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

const std::string kNothingSelected = "warning: the picture shows nothing: the selection is empty\n";

/// Pictures of the phantom, in a folder.
class PlayerRender : public testing::Test {
 protected:
  [[nodiscard]] ProgramResult run(const Words& words) const { return run_player(words, folder_.path()); }
  void render(const Words& options, const std::string& size = "40x30") const {
    const ProgramResult result = run(joined({"render", phantom_atlas(), "--size", size}, options));
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_THAT(result.err, testing::AnyOf(IsEmpty(), kNothingSelected));
  }
  [[nodiscard]] std::string bytes(const std::string& name) const { return read_bytes(folder_.file(name)); }
  [[nodiscard]] std::vector<float> pixels(const std::string& name) const {
    return read_pixels(folder_.file(name));
  }
  [[nodiscard]] nlohmann::json stats() const { return nlohmann::json::parse(bytes("s.json")); }
  void write_atlas(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_.file(name), std::ios::binary) << bytes;
  }

  TemporaryFolder folder_;
};

/// A label map of background only is a valid atlas. The default selection shows nothing of it.
TEST_F(PlayerRender, ShowsAnAtlasWithoutStructures) {
  std::ofstream(folder_.file("zero.nrrd"), std::ios::binary)
      << "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: 4 4 4\n"
         "space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\nencoding: raw\n\n"
      << std::string(64, '\0');
  const ProgramResult built = run_preprocess(
      {"build", "-o", "zero.atlas", "--labels", "zero.nrrd", "--progress", "none"}, folder_.path());
  ASSERT_EQ(built.status, 0) << built.err;
  for (const std::string text : {"*", "*:surface"}) {
    const ProgramResult rendered =
        run({"render", "zero.atlas", "-o", "zero.png", "--size", "4x3", "--select", text});
    EXPECT_EQ(rendered.status, 0) << rendered.err;
    EXPECT_EQ(rendered.err, kNothingSelected);
    EXPECT_THAT(pixels("zero.png"), testing::Each(0));
  }
}

TEST_F(PlayerRender, WritesEveryFormat) {
  for (const auto& [name, magic] :
       {std::pair("a.png", "\x89PNG"), {"a.jpg", "\xff\xd8"}, {"a.tif", ""}, {"a.exr", "\x76\x2f\x31\x01"}}) {
    render({"-o", name});
    EXPECT_THAT(bytes(name), StartsWith(magic));
  }
  EXPECT_EQ(folder_.names(), (Words{"a.exr", "a.jpg", "a.png", "a.tif"}));
}

TEST_F(PlayerRender, InBothProjectionsAndClassifications) {
  std::vector<std::vector<float>> pictures;
  for (const std::string projection : {"parallel", "perspective"}) {
    for (const std::string classify : {"before", "after"}) {
      render({"-o", "a.png", "--projection", projection, "--classify", classify, "--select", "*:volume"});
      pictures.push_back(pixels("a.png"));
      const auto [min, max] = std::minmax_element(pictures.back().begin(), pictures.back().end());
      EXPECT_EQ(*min, 0);
      EXPECT_GT(*max, 0.2f);
      for (std::size_t n = 0; n + 1 < pictures.size(); ++n) EXPECT_NE(pictures[n], pictures.back());
    }
  }
}

TEST_F(PlayerRender, PngAndTiffHoldTheSamePixels) {
  for (const std::string background : {"#204060", "transparent"}) {
    for (const std::string name : {"a.png", "a.tif"}) render({"-o", name, "--background", background});
    const std::vector<float> png = pixels("a.png");
    EXPECT_EQ(png.size(), std::size_t{40} * 30 * (background == "transparent" ? 4 : 3));
    EXPECT_EQ(png, pixels("a.tif"));
  }
}

TEST_F(PlayerRender, OutlinesDarkenSolidsAlone) {
  const auto outlined = [&](const std::string& selection) {
    const Words words{"--azimuth",    "120",     "--elevation", "20",      "--fit", "grid",
                      "--background", "#ffffff", "--select",    selection, "-o"};
    render(joined(words, {"a.png"}), "90x90");
    render(joined(words, {"b.png", "--outline", "edges"}), "90x90");
    const std::vector<float> without = pixels("a.png"), with = pixels("b.png");
    std::vector<bool> changed;
    for (std::size_t n = 0; n < with.size(); ++n) changed.push_back(with[n] < without[n]);
    return changed;
  };
  const std::vector<bool> solid = outlined("Sphere_1:surface");
  EXPECT_GT(std::ranges::count(solid, true), 200);
  EXPECT_EQ(outlined("Sphere_1:surface + Sphere_2:surface(ghost)"), solid);
  EXPECT_THAT(outlined("*:surface(opacity=0.97)"), testing::Each(false));
}

TEST_F(PlayerRender, APaletteReplacesColoursThatTheSelectionDoesNotGive) {
  const std::string of_options = "Sphere_1:surface(color=#eebb00) + Sphere_2:surface(color=#102030)";
  render({"-o", "a.png", "--annotate", "legend", "--select", of_options}, "240x180");
  render({"-o", "b.png", "--annotate", "legend", "--palette", "distinct", "--select",
          "Sphere_1:surface + Sphere_2:surface(color=#102030)"},
         "240x180");
  EXPECT_EQ(bytes("a.png"), bytes("b.png"));
}

TEST_F(PlayerRender, ABackgroundOfTwoColoursIsAGradient) {
  for (const std::string name : {"g.png", "g.tif", "g.jpg"}) {
    render({"-o", name, "--select", "", "--background", "#000000,#c8643c"}, "5x201");
    const std::vector<float> picture = pixels(name);
    ASSERT_EQ(picture.size(), std::size_t{3} * 5 * 201);
    const std::array<float, 3> bottom{0xc8 / 255.0f, 0x64 / 255.0f, 0x3c / 255.0f};
    for (std::size_t y = 0; y <= 200; y += 50) {
      for (std::size_t n = 0; n < 15; ++n) {
        const float expected = bottom[n % 3] * static_cast<float>(y) / 200;
        EXPECT_NEAR(picture[15 * y + n], expected, name == "g.jpg" ? 0.03f : 0.004f) << name << " row " << y;
      }
    }
  }
  // Structures hide it, as any background
  render({"-o", "a.png", "--select", "*:surface", "--background", "#204060,#204060"});
  render({"-o", "b.png", "--select", "*:surface", "--background", "#204060"});
  EXPECT_TRUE(bytes("a.png") == bytes("b.png"));
}

TEST_F(PlayerRender, WarnsOfPicturesThatShowNothing) {
  const auto warnings_of = [&](const Words& options) {
    const ProgramResult result =
        run(joined({"render", phantom_atlas(), "-o", "w.png", "--size", "32x32"}, options));
    EXPECT_EQ(result.status, 0) << result.err;
    return result.err;
  };
  EXPECT_EQ(warnings_of({"--select", ""}), kNothingSelected);
  EXPECT_EQ(warnings_of({"--select", "Sphere* - Sphere*"}), kNothingSelected);
  const std::string nothing =
      "warning: the picture shows nothing of the selection: it is transparent, removed by a cut or beside "
      "the picture\n";
  EXPECT_EQ(warnings_of({"--cut", "left=-1000", "--fit", "grid"}), nothing);
  EXPECT_EQ(warnings_of({"--center", "900,0,0"}), nothing);
  EXPECT_EQ(warnings_of({"--cap", "labels"}), "warning: --cap has no effect without --cut\n");
  EXPECT_EQ(warnings_of({"--cap", "labels", "--cut", "left=16", "--select", "#1 + rest"}), "");
  EXPECT_EQ(warnings_of({"--elevation", "120", "--select", "*:volume(ghost) + rest"}),
            "warning: selection, column 1: ghost has no effect on a volume; write :surface(ghost)\n"
            "warning: selection, column 19: rest selects nothing: the other terms name every structure\n"
            "warning: --elevation 120 lies beyond the pole: what is superior points down\n");
}

TEST_F(PlayerRender, WarnsOfHiddenTerms) {
  std::string many = "#1";
  for (int n = 0; n < 8; ++n) many += " + #1";
  const ProgramResult result =
      run({"render", phantom_atlas(), "-o", "w.png", "--size", "8x8", "--select", many});
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(result.err, StartsWith("warning: selection, column 1: \"#1\" has no effect: "));
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 6);
  EXPECT_THAT(result.err, HasSubstr("warning: selection: 3 more terms are hidden\n"));
}

/// The last chunk holds Sphere 2's values.
TEST_F(PlayerRender, DamageOmitsItsStructureAndFails) {
  std::string damaged_bytes = read_bytes(phantom_atlas());
  damaged_bytes.back() = static_cast<char>(damaged_bytes.back() ^ 1);
  write_atlas("bad.atlas", damaged_bytes);
  const auto draw = [&](const std::string& atlas, const std::string& select) {
    return run({"render", atlas, "-o", "x.png", "--select", select, "--size", "40x30", "--stats", "s.json"});
  };
  const ProgramResult damaged = draw("bad.atlas", "*");
  EXPECT_EQ(damaged.status, 3);
  EXPECT_EQ(
      damaged.err,
      "splatlas-player: \"Sphere_2\": its volume of 901 voxels is missing: bad.atlas: damaged: checksum of "
      "values of classes 3 to 4\n"
      "splatlas-player: bad.atlas: damaged; x.png was written without what is missing\n");
  const nlohmann::json missing = stats()["missing"];
  EXPECT_EQ(missing.size(), 1u);
  EXPECT_EQ(missing[0]["structure"], "Sphere_2");
  EXPECT_EQ(missing[0]["part"], "volume");
  EXPECT_EQ(missing[0]["voxels"], 901);
  const std::vector<float> rest = pixels("x.png");
  EXPECT_EQ(draw(phantom_atlas(), "\"Sphere 1\"").status, 0);
  EXPECT_EQ(pixels("x.png"), rest);

  // Sphere 2 alone leaves nothing to draw; the other structures are complete.
  std::filesystem::remove(folder_.file("x.png"));
  EXPECT_EQ(draw("bad.atlas", "\"Sphere 2\"").status, 3);
  EXPECT_FALSE(std::filesystem::exists(folder_.file("x.png")));
  EXPECT_EQ(draw("bad.atlas", "\"Sphere 1\" + \"Sphere 2\":surface").status, 0);
}

TEST(PlayerInfo, TheTextListsEveryStructure) {
  const ProgramResult info = run_player({"info", phantom_atlas()});
  EXPECT_EQ(info.status, 0);
  EXPECT_THAT(info.out, HasSubstr("Sphere 1"));
  EXPECT_THAT(info.out, HasSubstr("32 x 32 x 32"));
  EXPECT_THAT(info.out, HasSubstr("\nextent    left -0.5 to 31.5 (right -31.5 to 0.5), posterior -0.5 to "));
}

const std::string kFont = "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf";

TEST(PlayerOutput, IsNeverTheFont) {
  const TemporaryFolder fonts;
  const std::string font = fonts.file("font.png"), before = read_bytes(kFont);
  fs::copy_file(kFont, font);
  fs::create_symlink(font, fonts.file("link.json"));
  const Words annotated{"render", phantom_atlas(), "--annotate", "caption", "--caption", "A", "--font", font};
  for (const Words& words : {Words{"-o", font},
                             {"-o", "x.png", "--stats", fonts.file("link.json")},
                             {"-o", "x.png", "--ids", font}}) {
    const ProgramResult result = run_player(joined(annotated, words), fonts.path());
    EXPECT_EQ(result.status, 2) << words.back();
    EXPECT_EQ(result.err,
              "splatlas-player: " + words.back() + ": is an input (" + font + "); write to another file\n");
    EXPECT_TRUE(read_bytes(font) == before);
    EXPECT_THAT(fonts.names(), ElementsAre("font.png", "link.json"));
  }
}

TEST(PlayerOutput, FailsOnAFullStandardOutput) {
  for (const Words& words : {Words{"verify", phantom_atlas()},
                             {"info", phantom_atlas()},
                             {"info", phantom_atlas(), "--json"},
                             {"--help"},
                             {"render", "--help"},
                             {"--version"}}) {
    const ProgramResult result =
        run_by_shell(kFullDevice, joined({SPLATLAS_PLAYER}, words), phantom_folder().path());
    EXPECT_EQ(result.status, 1) << words.front();
    EXPECT_EQ(result.err, "splatlas-player: standard output: cannot be written: No space left on device\n");
  }
}

}  // namespace
}  // namespace splatlas
