// Annotated pictures and documents from the command line.

#include <gmock/gmock.h>

#include "tests/cli/hostile_atlas.h"
#include "tests/cli/phantom_atlas.h"
#include "tests/cli/read_pixels.h"
#include "tests/support/fails_with.h"
#include "tests/support/file_bytes.h"

namespace splatlas {
namespace {

struct Annotate : testing::Test {
  TemporaryFolder folder;
  [[nodiscard]] ProgramResult render(const Words& options) const {
    return run_player(joined({"render", phantom_atlas()}, options), folder.path());
  }
  [[nodiscard]] std::string text_of(const std::string& pdf) const {
    return run_program({"pdftotext", "-layout", pdf, "-"}, folder.path()).out;
  }
};

const Words kScene{"--size", "900x600", "--fit", "grid", "--zoom", "0.5", "--azimuth", "20"};

TEST_F(Annotate, KeepsOtherPixels) {
  const ProgramResult plain = render(joined(kScene, {"-o", "a.png"}));
  const ProgramResult labelled = render(joined(kScene, {"-o", "b.png", "--annotate", "all"}));
  ASSERT_EQ(plain.status, 0) << plain.err;
  ASSERT_EQ(labelled.status, 0) << labelled.err;
  EXPECT_THAT(labelled.err, HasSubstr("note: the atlas has no citation"));
  const auto a = read_pixels(folder.file("a.png")), b = read_pixels(folder.file("b.png"));
  ASSERT_EQ(a.size(), b.size());
  std::size_t changed = 0;
  for (std::size_t n = 0; n < a.size(); n += 3)
    changed += a[n] != b[n] || a[n + 1] != b[n + 1] || a[n + 2] != b[n + 2];
  EXPECT_GT(changed, 1000u);
  EXPECT_LT(changed, a.size() / 3 / 10);
}

TEST_F(Annotate, LeavesRoomForAnnotations) {
  for (const std::string view : {"anterior", "left", "superior"}) {
    const ProgramResult result = render(
        {"-o", "a.png", "--size", "900x700", "--view", view, "--annotate", "all", "--caption", "Spheres"});
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_THAT(result.err, Not(HasSubstr("cover"))) << view;
    EXPECT_THAT(result.err, Not(HasSubstr("label"))) << view;
  }
}

TEST_F(Annotate, IsReproducible) {
  for (const std::string ending : {"png", "svg", "pdf", "tif", "exr", "jpg"}) {
    for (const std::string name : {"a.", "b."}) {
      const ProgramResult result =
          render(joined(kScene, {"-o", name + ending, "--annotate", "labels,scalebar"}));
      ASSERT_EQ(result.status, 0) << result.err;
    }
    EXPECT_TRUE(read_bytes(folder.file("a." + ending)) == read_bytes(folder.file("b." + ending))) << ending;
  }
}

TEST_F(Annotate, WritesPdfPagesWithText) {
  const ProgramResult result =
      render({"-o", "page.pdf", "--size", "2480x3508", "--dpi", "300", "--zoom", "0.6", "--annotate",
              "labels,legend,scalebar,orientation,caption", "--caption", "B\xc3\xa4lle \xce\xb1 \xd0\xaf"});
  ASSERT_EQ(result.status, 0) << result.err;
  const std::string info = run_program({"pdfinfo", "page.pdf"}, folder.path()).out;
  EXPECT_THAT(info, HasSubstr("595.2 x 841.92 pts (A4)"));
  const std::string text = text_of("page.pdf");
  EXPECT_THAT(text, HasSubstr("Sphere 1"));
  EXPECT_THAT(text, HasSubstr("mm"));
  EXPECT_THAT(text, HasSubstr("B\xc3\xa4lle \xce\xb1 \xd0\xaf"));
  EXPECT_EQ(render({"-o", "plain.pdf"}).status, 0);
  EXPECT_EQ(text_of("plain.pdf").find("Sphere"), std::string::npos);
}

TEST_F(Annotate, WritesEveryScriptAndNotesMissingLetters) {
  const std::string hebrew = "\xd7\xa1\xd7\x95\xd7\xa3", caption =
                                                             "Gr\xc3\xb6\xc3\x9f"
                                                             "e \xd0\x9b\xd0\xb5\xd0\xb2\xd0\xbe\xd0\xb5 " +
                                                             hebrew;
  for (const std::string name : {"a.png", "a.pdf", "a.svg"}) {
    const ProgramResult result = render({"-o", name, "--annotate", "caption", "--caption", caption});
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_THAT(result.err, Not(HasSubstr("no font"))) << name;
  }
  EXPECT_THAT(text_of("a.pdf"), HasSubstr("Gr\xc3\xb6\xc3\x9f"
                                          "e \xd0\x9b\xd0\xb5\xd0\xb2\xd0\xbe\xd0\xb5"));
  EXPECT_THAT(read_bytes(folder.file("a.svg")), HasSubstr(caption + "</text>"));
  const std::string unassigned = "\xf4\x80\x80\x80";
  const ProgramResult result =
      render({"-o", "b.svg", "--annotate", "caption", "--caption", "a" + unassigned});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("note: no font has all letters of \"a"));
}

/// Bytes of the texts in an SVG file.
std::size_t letters_of(const std::string& svg) {
  std::size_t letters = 0;
  for (std::size_t at = svg.find("<text"); at != std::string::npos; at = svg.find("<text", at + 1))
    letters += svg.find("</text>", at) - svg.find('>', at) - 1;
  return letters;
}

TEST_F(Annotate, CutsLongNames) {
  write_bytes(folder.file("a.atlas"),
              value_or_throw(encode_atlas(hostile_content({"a"}, {std::string(5000, 'i')}))));
  const ProgramResult result =
      run_player({"render", "a.atlas", "-o", "a.svg", "--annotate", "labels"}, folder.path());
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(letters_of(read_bytes(folder.file("a.svg"))), 803u) << "cut off with an ellipsis";
}

TEST_F(Annotate, BreaksLongTextsInTime) {
  const ProgramResult result = render({"-o", "a.svg", "--size", "3000x3000", "--dpi", "100", "--annotate",
                                       "caption", "--caption", std::string(5000, 'i')});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(letters_of(read_bytes(folder.file("a.svg"))), 4003u) << "cut off with an ellipsis";
}

TEST_F(Annotate, StoresTheResolution) {
  ASSERT_EQ(render({"-o", "a.png", "--dpi", "300", "--size", "64x64"}).status, 0);
  const auto input = OIIO::ImageInput::open(folder.file("a.png"));
  ASSERT_TRUE(input);
  // Stored as 11811 pixels per metre.
  EXPECT_NEAR(input->spec().get_float_attribute("XResolution") *
                  (input->spec().get_string_attribute("ResolutionUnit") == "cm" ? 2.54 : 1),
              300, 0.5);
}

}  // namespace
}  // namespace splatlas
