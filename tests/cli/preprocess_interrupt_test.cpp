// Interrupted runs of splatlas-preprocess: Ctrl-C, SIGTERM and SIGHUP leave complete files only.

#include <array>
#include <chrono>
#include <csignal>
#include <fstream>
#include <random>
#include <thread>

#include <gmock/gmock.h>

#include "tests/cli/programs.h"

namespace splatlas {
namespace {

using namespace std::chrono_literals;

/// labels.mha (64 blocks of 16x16x16 voxels), volume.mha (noise) and cubes.atlas, built from them.
const TemporaryFolder& cubes() {
  static const TemporaryFolder folder;
  static const bool built = [] {
    constexpr unsigned kSize = 64, kBlock = 16;
    const std::string header =
        "ObjectType = Image\nNDims = 3\nDimSize = 64 64 64\nElementType = MET_UCHAR\nElementDataFile = "
        "LOCAL\n";
    std::string labels, noise;
    std::mt19937 random(1);
    for (unsigned v = 0; v < kSize * kSize * kSize; ++v) {
      const unsigned i = v % kSize / kBlock, j = v / kSize % kSize / kBlock, k = v / kSize / kSize / kBlock;
      labels += static_cast<char>(1 + i + 4 * j + 16 * k);
      noise += static_cast<char>(random());
    }
    std::ofstream(folder.file("labels.mha"), std::ios::binary) << header << labels;
    std::ofstream(folder.file("volume.mha"), std::ios::binary) << header << noise;
    const ProgramResult build = run_preprocess({"build", "-o", "cubes.atlas", "--labels", "labels.mha",
                                                "--volume", "volume.mha", "--progress", "none"},
                                               folder.path());
    EXPECT_EQ(build.status, 0) << build.err;
    return build.status == 0;
  }();
  EXPECT_TRUE(built);
  return folder;
}

constexpr std::array kSignals{SIGINT, SIGTERM, SIGHUP};

class PreprocessInterrupt : public testing::Test {
 protected:
  /// Runs `words` once to its end, then repeatedly with an interrupt: at times spread over the run, and as
  /// soon as a hidden file appears in the folder. Each run may leave only `output`, which is then removed.
  void interrupt(const std::vector<std::string>& words, const std::string& output) const {
    const auto start = std::chrono::steady_clock::now();
    ASSERT_EQ(run_program(words, folder_.path()).status, 0);
    const auto usual_time = std::chrono::steady_clock::now() - start;
    std::filesystem::remove_all(folder_.file(output));

    constexpr int kMoments = 8;
    int interrupted = 0;
    for (int n = 0; n < 2 * kMoments; ++n) {
      const int signal = kSignals[static_cast<std::size_t>(n) % kSignals.size()];
      const ProgramResult result = run_program(words, folder_.path(), [&](int process) {
        if (n < kMoments) {
          std::this_thread::sleep_for(usual_time * n / kMoments);
        } else {
          await_hidden_file(3 * usual_time);
        }
        ::kill(process, signal);
      });
      SCOPED_TRACE(testing::Message() << "moment " << n << ", status " << result.status);
      EXPECT_THAT(result.status, testing::AnyOf(0, 128 + signal));
      interrupted += result.status != 0 ? 1 : 0;
      for (const std::string& name : folder_.names()) EXPECT_EQ(name, output);
      EXPECT_TRUE(result.status != 0 || std::filesystem::exists(folder_.file(output)));
      std::filesystem::remove_all(folder_.file(output));
    }
    EXPECT_GT(interrupted, 0);
  }

 private:
  void await_hidden_file(std::chrono::steady_clock::duration upper_bound) const {
    const auto end = std::chrono::steady_clock::now() + upper_bound;
    while (std::chrono::steady_clock::now() < end) {
      for (const std::string& name : folder_.names()) {
        if (name.front() == '.') return;
      }
    }
  }

 protected:
  TemporaryFolder folder_;
};

TEST_F(PreprocessInterrupt, MasksAppearTogetherOrNotAtAll) {
  interrupt({SPLATLAS_PREPROCESS, "export", cubes().file("cubes.atlas"), "--labels", "masks/"}, "masks");
}

TEST_F(PreprocessInterrupt, VolumesAppearWholeOrNotAtAll) {
  interrupt({SPLATLAS_PREPROCESS, "export", cubes().file("cubes.atlas"), "--volume", "volume.nii.gz"},
            "volume.nii.gz");
}

TEST_F(PreprocessInterrupt, SurfacesAppearWholeOrNotAtAll) {
  interrupt({SPLATLAS_PREPROCESS, "export", cubes().file("cubes.atlas"), "--surface", "Label*=s.stl"},
            "s.stl");
}

TEST_F(PreprocessInterrupt, AtlasesAppearWholeOrNotAtAll) {
  interrupt({SPLATLAS_PREPROCESS, "build", "-o", "a.atlas", "--labels", cubes().file("labels.mha"),
             "--volume", cubes().file("volume.mha"), "--progress", "none"},
            "a.atlas");
}

}  // namespace
}  // namespace splatlas
