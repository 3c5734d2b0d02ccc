// Colin 27 by every instruction set: one picture on every CPU.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/cli/read_pixels.h"
#include "tests/support/run_program.h"

namespace splatlas {
namespace {

const std::string kTemplates = "/usr/share/mricron/templates/";  // of Debian's package mricron-data

/// SPLATLAS_SIMD while it lives.
class ForcedSimd {
 public:
  explicit ForcedSimd(const char* name) { setenv("SPLATLAS_SIMD", name, 1); }
  ~ForcedSimd() { unsetenv("SPLATLAS_SIMD"); }
  ForcedSimd(const ForcedSimd&) = delete;
  ForcedSimd& operator=(const ForcedSimd&) = delete;
};

std::vector<float> rendered(const TemporaryFolder& folder, const char* simd,
                            const std::vector<std::string>& options) {
  const ForcedSimd forced(simd);
  std::vector<std::string> command{SPLATLAS_PLAYER, "render", "colin27.atlas", "-o", "picture.exr"};
  command.insert(command.end(), options.begin(), options.end());
  const ProgramResult render = run_program(command, folder.path());
  EXPECT_EQ(render.status, 0) << render.err;
  return read_pixels(folder.file("picture.exr"));
}

TEST(InstructionSets, AgreeWithTheScalarReferenceOnColin27) {
  const TemporaryFolder folder;
  const ProgramResult build =
      run_program({SPLATLAS_PREPROCESS, "build", "-o", "colin27.atlas", "--labels", kTemplates + "aal.nii.gz",
                   "--names", kTemplates + "aal.nii.txt", "--volume", kTemplates + "ch2.nii.gz", "--progress",
                   "none", "--level", "1"},
                  folder.path());
  ASSERT_EQ(build.status, 0) << build.err;

  const std::array<std::vector<std::string>, 5> views{{{"--view", "anterior"},
                                                       {"--view", "left", "--zoom", "2.5"},
                                                       {"--view", "superior"},
                                                       {"--azimuth", "37", "--elevation", "25"},
                                                       {"--azimuth", "-120", "--elevation", "-50"}}};
  const std::array<std::vector<std::string>, 5> ways{
      {{"--quality", "normal"},
       {"--projection", "perspective", "--quality", "draft"},
       {"--projection", "perspective", "--quality", "normal"},
       {"--classify", "after", "--quality", "high"},
       {"--classify", "after", "--projection", "perspective", "--quality", "normal"}}};
  const std::array<std::string, 3> selections{
      "*", "*_L(profile=hard,low=40,high=160) + Cerebel*:surface(opacity=0.5)", "*(profile=thin)"};
  std::size_t seen = 0;
  for (std::size_t view = 0; view < views.size(); ++view) {
    for (std::size_t way = 0; way < ways.size(); ++way) {
      std::vector<std::string> options{"--size", "96x96", "--select", selections[(view + way) % 3]};
      options.insert(options.end(), views[view].begin(), views[view].end());
      options.insert(options.end(), ways[way].begin(), ways[way].end());
      const std::vector<float> reference = rendered(folder, "scalar", options);
      ASSERT_EQ(reference.size(), 4u * 96 * 96);
      seen += static_cast<std::size_t>(std::ranges::count_if(reference, [](float v) { return v > 0.01f; }));
      for (const char* const simd : {"sse4", "avx2", "avx3"}) {  // those that the machine lacks: its best
        const std::vector<float> picture = rendered(folder, simd, options);
        ASSERT_EQ(picture.size(), reference.size());
        float largest = 0;
        for (std::size_t n = 0; n < picture.size(); ++n)
          largest = std::max(largest, std::abs(picture[n] - reference[n]));
        EXPECT_LE(largest, 2e-5f) << simd << ", view " << view << ", way " << way;
      }
    }
  }
  EXPECT_GT(seen, 100000u);
}

}  // namespace
}  // namespace splatlas
