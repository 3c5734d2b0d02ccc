// Commands of both programs that write files, each over an old one.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace splatlas {

struct FaultScenario {
  std::string name;
  std::vector<std::string> words;  ///< of the command, to be run in the folder
  std::string output;              ///< the file or folder that it makes or replaces
  bool replaces = true;            ///< there is an old output
};

/// Writes a small volume with its labels, and an atlas of them, into the folder.
void prepare_inputs(const std::filesystem::path& folder);

/// Builds, exports of every kind and renderings to every kind of picture.
[[nodiscard]] std::vector<FaultScenario> fault_scenarios();

}  // namespace splatlas
