// Colin 27 by every instruction set: one picture on every CPU.
#include <algorithm>
#include <array>
#include <cstdlib>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/cli/programs.h"
#include "tests/cli/read_pixels.h"

namespace splatlas {
namespace {

const std::string kTemplates = "/usr/share/mricron/templates/";  // of Debian's package mricron-data

/// Sets SPLATLAS_SIMD during its lifetime.
class ForcedSimd {
 public:
  explicit ForcedSimd(const char* name) { setenv("SPLATLAS_SIMD", name, 1); }
  ~ForcedSimd() { unsetenv("SPLATLAS_SIMD"); }
  ForcedSimd(const ForcedSimd&) = delete;
  ForcedSimd& operator=(const ForcedSimd&) = delete;
};

std::vector<float> rendered(const TemporaryFolder& folder, const char* simd, const Words& options) {
  const ForcedSimd forced(simd);
  const ProgramResult render =
      run_player(joined({"render", "colin27.atlas", "-o", "picture.exr"}, options), folder.path());
  EXPECT_EQ(render.status, 0) << render.err;
  return read_pixels(folder.file("picture.exr"));
}

TEST(InstructionSets, AgreeWithTheScalarReferenceOnColin27) {
  const TemporaryFolder folder;
  const ProgramResult build =
      run_preprocess({"build", "-o", "colin27.atlas", "--labels", kTemplates + "aal.nii.gz", "--names",
                      kTemplates + "aal.nii.txt", "--volume", kTemplates + "ch2.nii.gz", "--progress", "none",
                      "--level", "1"},
                     folder.path());
  ASSERT_EQ(build.status, 0) << build.err;

  std::vector<const char*> available;
  for (const char* const simd : {"sse4", "avx2", "avx3"}) {
    const ForcedSimd forced(simd);
    if (run_player({"info", "colin27.atlas"}, folder.path()).status == 0) available.push_back(simd);
  }

  const std::array<Words, 5> views{{{"--view", "anterior"},
                                    {"--view", "left", "--zoom", "2.5"},
                                    {"--view", "superior"},
                                    {"--azimuth", "37", "--elevation", "25"},
                                    {"--azimuth", "-120", "--elevation", "-50"}}};
  const std::array<Words, 5> modes{
      {{"--quality", "normal"},
       {"--projection", "perspective", "--quality", "draft"},
       {"--projection", "perspective", "--quality", "normal"},
       {"--classify", "after", "--quality", "high"},
       {"--classify", "after", "--projection", "perspective", "--quality", "normal"}}};
  const std::array<std::string, 3> selections{
      "*", "*_L(profile=hard,low=40,high=160) + Cerebel*:surface(opacity=0.5)", "*(profile=thin)"};
  std::size_t seen = 0;
  for (std::size_t view = 0; view < views.size(); ++view) {
    for (const std::size_t mode : {view, (view + 2) % modes.size()}) {
      const Words common{"--size", "96x96", "--select", selections[(view + mode) % 3]};
      const Words options = joined(joined(common, views[view]), modes[mode]);
      const std::vector<float> reference = rendered(folder, "scalar", options);
      ASSERT_EQ(reference.size(), 4u * 96 * 96);
      seen += static_cast<std::size_t>(std::ranges::count_if(reference, [](float v) { return v > 0.01f; }));
      for (const char* const simd : available) {
        const std::vector<float> picture = rendered(folder, simd, options);
        ASSERT_EQ(picture.size(), reference.size());
        EXPECT_LE(largest_difference(picture, reference), 2e-5f)
            << simd << ", view " << view << ", mode " << mode;
      }
    }
  }
  EXPECT_GT(seen, 40000u);
}

}  // namespace
}  // namespace splatlas
