#include "tests/faults/fault_scenarios.h"

#include <fstream>
#include <random>
#include <stdexcept>

#include <fmt/format.h>

#include "tests/support/run_program.h"

namespace splatlas {
namespace {

constexpr unsigned kSize = 20;

/// Two structures, one in each half of the grid, and noise as grey values.
void write_sources(const std::filesystem::path& folder) {
  const std::string header = fmt::format(
      "ObjectType = Image\nNDims = 3\nDimSize = {0} {0} {0}\nElementType = MET_UCHAR\n"
      "ElementDataFile = LOCAL\n",
      kSize);
  std::string labels, greys;
  std::mt19937 random(1);
  for (unsigned v = 0; v < kSize * kSize * kSize; ++v) {
    const unsigned i = v % kSize, j = v / kSize % kSize, k = v / kSize / kSize;
    const bool is_inside = i > 2 && i < 17 && j > 3 && j < 16 && k > 2 && k < 15;
    labels += static_cast<char>(is_inside ? 1 + (i > 9 ? 1 : 0) : 0);
    greys += static_cast<char>(random() % 256);
  }
  std::ofstream(folder / "labels.mha", std::ios::binary) << header << labels;
  std::ofstream(folder / "volume.mha", std::ios::binary) << header << greys;
  std::ofstream(folder / "names.txt") << "1 left\n2 right\n";
}

std::vector<std::string> build_words(const std::string& output) {
  return {SPLATLAS_PREPROCESS, "build",      "-o",      output,      "--labels",   "labels.mha",
          "--volume",          "volume.mha", "--names", "names.txt", "--progress", "none"};
}

FaultScenario exported(const std::string& output, const std::string& option, const std::string& value,
                       bool replaces = true) {
  return {"export " + output, {SPLATLAS_PREPROCESS, "export", "in.atlas", option, value}, output, replaces};
}

}  // namespace

void prepare_inputs(const std::filesystem::path& folder) {
  write_sources(folder);
  const ProgramResult built = run_program(build_words("in.atlas"), folder);
  if (built.status != 0) throw std::runtime_error("cannot build the atlas: " + built.err);
}

std::vector<FaultScenario> fault_scenarios() {
  std::vector<FaultScenario> scenarios{{"build", build_words("out.atlas"), "out.atlas"},
                                       {"build --compact", build_words("out.atlas"), "out.atlas"}};
  scenarios[1].words.emplace_back("--compact");
  for (const char* format : {"nrrd", "nii", "nii.gz", "mha"}) {
    scenarios.push_back(
        exported(fmt::format("labels.{}", format), "--labels", fmt::format("labels.{}", format)));
  }
  scenarios[5].output = scenarios[5].words[4] = "exported.mha";  // labels.mha is an input
  scenarios.push_back(exported("volume.nrrd", "--volume", "volume.nrrd"));
  scenarios.push_back(exported("masks", "--labels", "masks/", false));
  for (const char* format : {"stl", "ply", "obj", "vtk"}) {
    scenarios.push_back(
        exported(fmt::format("surface.{}", format), "--surface", fmt::format("left=surface.{}", format)));
  }
  for (const char* format : {"png", "jpg", "tif", "exr"}) {
    const std::string output = fmt::format("picture.{}", format);
    scenarios.push_back({"render " + output,
                         {SPLATLAS_PLAYER, "render", "in.atlas", "-o", output, "--select",
                          "left + right:surface", "--size", "32x32", "--threads", "1"},
                         output});
  }
  return scenarios;
}

}  // namespace splatlas
