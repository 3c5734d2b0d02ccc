// Commands of both programs that write files, each over an existing output.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace splatlas {

struct FaultScenario {
  std::string name;
  std::vector<std::string> words;  ///< command line, to be run in the folder
  std::string output;              ///< file or folder that it creates or replaces
  bool replaces = true;            ///< an old output exists
};

/// Writes a small volume, its labels and an atlas of them into the folder.
void prepare_inputs(const std::filesystem::path& folder);

/// Builds, exports of every kind and pictures in every format.
[[nodiscard]] std::vector<FaultScenario> fault_scenarios();

}  // namespace splatlas
