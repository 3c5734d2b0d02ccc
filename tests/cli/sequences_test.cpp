// Pictures to standard output, handouts of scenes, and turns.

#include <fstream>

#include <gmock/gmock.h>

#include "tests/cli/programs.h"
#include "tests/cli/read_pixels.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

struct Sequences : testing::Test {
  TemporaryFolder folder;
  Sequences() {
    std::ofstream(folder.file("labels.nrrd"), std::ios::binary)
        << "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: 12 4 4\n"
           "space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\nencoding: raw\n\n"
        << std::string(96, '\1') + std::string(96, '\2');
    std::ofstream(folder.file("lesson.toml"))
        << "[[scene]]\nname = \"<b>A&B\"\nselect = \"*:surface\"\nquestion = \"Which \\\"one\\\"?\"\n"
           "caption = \"First.\\n</p><script>Second.\"\n"
           "[[scene]]\nname = \"Upper\"\nselect = \"#2:surface\"\nazimuth = 35\n";
    const ProgramResult built = run_preprocess(
        {"build", "-o", "a.atlas", "--labels", "labels.nrrd", "--scene", "lesson.toml", "--progress", "none"},
        folder.path());
    EXPECT_EQ(built.status, 0) << built.err;
  }
  [[nodiscard]] ProgramResult render(const Words& options) const {
    return run_player(joined({"render", "a.atlas", "--size", "300x200"}, options), folder.path());
  }
  [[nodiscard]] auto bytes(const std::string& name) const { return read_bytes(folder.file(name)); }
};

TEST_F(Sequences, StandardOutputIsTheFile) {
  const Words options{"--scene", "Upper", "--annotate", "scalebar"};
  ASSERT_EQ(render(joined(options, {"-o", "a.png"})).status, 0);
  EXPECT_TRUE(render(joined(options, {"-o", "-"})).out == bytes("a.png"));
  const ProgramResult failed = render({"-o", "-", "--select", "Liver"});
  EXPECT_EQ(failed.status, 4);
  EXPECT_EQ(failed.out, "");
  const Words words{SPLATLAS_PLAYER, "render", "a.atlas", "-o", "-"};
  EXPECT_EQ(run_by_shell(kFullDevice, words, folder.path()).status, 1);
  const ProgramResult terminal = run_by_shell(R"(exec script -qec "$0 $*" /dev/null)", words, folder.path());
  EXPECT_THAT(terminal.out, HasSubstr("standard output is a terminal; redirect it"));
}

TEST_F(Sequences, HandoutHasAllScenes) {
  ASSERT_EQ(render({"--scenes", "h"}).status, 0);
  EXPECT_EQ(run_program({"ls", "h"}, folder.path()).out, "01.png\n02.png\nhandout.html\nhandout.pdf\n");
  ASSERT_EQ(render({"-o", "2.png", "--scene", "Upper", "--background", "#ffffff"}).status, 0);
  EXPECT_TRUE(bytes("h/02.png") == bytes("2.png"));
  EXPECT_THAT(
      bytes("h/handout.html"),
      AllOf(HasSubstr("<h2 dir=\"auto\">1. &lt;b&gt;A&amp;B</h2>\n<img src=\"01.png\" "
                      "alt=\"1. &lt;b&gt;A&amp;B\">\n<em dir=\"auto\">Which &quot;one&quot;?</em>\n"
                      "<p dir=\"auto\">First.\n&lt;/p&gt;&lt;script&gt;Second.</p>\n</section>"),
            HasSubstr("default-src 'none'"), HasSubstr("<img src=\"02.png\""), Not(HasSubstr("<script"))));
  EXPECT_THAT(run_program({"pdfinfo", "h/handout.pdf"}, folder.path()).out,
              AllOf(HasSubstr("Pages:           2\n"), HasSubstr("(A4)")));
  EXPECT_EQ(run_program({"pdftotext", "h/handout.pdf", "-"}, folder.path()).out,
            "1. <b>A&B\n\nWhich \"one\"?\nFirst.\n</p><script>Second.\n\n\f2. Upper\n\n\f");
}

TEST_F(Sequences, TurnHasOneCamera) {
  const Words grid{"--fit", "grid", "--zoom", "1.2"};
  ASSERT_EQ(render(joined(grid, {"-o", "t", "--azimuth", "20", "--turn", "180", "--frames", "2"})).status, 0);
  ASSERT_EQ(render(joined(grid, {"-o", "a.png", "--azimuth", "20"})).status, 0);
  ASSERT_EQ(render(joined(grid, {"-o", "b.png", "--azimuth", "110"})).status, 0);
  EXPECT_TRUE(bytes("t/0001.png") == bytes("a.png"));
  EXPECT_TRUE(bytes("t/0002.png") == bytes("b.png"));

  // The fit holds for all frames: the first one sees the wedge from its short end
  const Words wedge{"--cut", "1,0,1,4", "--elevation", "40", "--azimuth", "90", "--select", "*:surface"};
  ASSERT_EQ(render(joined(wedge, {"-o", "u", "--turn", "360", "--frames", "8"})).status, 0);
  for (int n = 1; n <= 8; ++n) {
    const auto pixels = read_pixels(folder.file("u/000" + std::to_string(n) + ".png"));
    ASSERT_EQ(pixels.size(), 300u * 200 * 3);
    float border = 0;
    for (std::size_t at = 0; at < pixels.size(); ++at)
      border += at / 3 % 300 % 299 == 0 || at / 900 % 199 == 0 ? pixels[at] : 0;
    EXPECT_EQ(border, 0) << n;
  }
}

TEST_F(Sequences, FailuresLeaveNothing) {
  ASSERT_EQ(run_preprocess({"build", "-o", "b.atlas", "--labels", "labels.nrrd"}, folder.path()).status, 0);
  const auto before = folder.names();
  for (const auto& [options, status, message] :
       {std::tuple<Words, int, std::string>{
            {"b.atlas", "--scenes", "x"}, 1, "no scenes; add some with splatlas-preprocess lesson"},
        {{"a.atlas", "--scenes", "x", "--view", "left"}, 2, "--view excludes --scenes"},
        {{"a.atlas", "--scenes", "x", "--center", "Liver"}, 4, "--center"},
        {{"a.atlas", "-o", "x.png", "--turn", "90", "--frames", "3"}, 2, "x.png: must name a folder"}}) {
    const ProgramResult failed = run_player(joined({"render"}, options), folder.path());
    EXPECT_EQ(failed.status, status) << failed.err;
    EXPECT_THAT(failed.err, HasSubstr(message));
    EXPECT_EQ(folder.names(), before);
  }
}

}  // namespace
}  // namespace splatlas
