// Command line shared by the harnesses that count points of failure.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace splatlas {

/// The points to run: `first` and every `every`-th after it, in scenarios whose name contains `only`.
struct ChosenPoints {
  std::uint64_t every = 1, first = 0;
  std::string only;
};

/// Parses --every, --first and --only, and runs. Returns the exit status of the program.
[[nodiscard]] int run_harness(int argc, char** argv, const std::string& name, const std::string& what,
                              const std::function<int(const ChosenPoints&)>& run);

}  // namespace splatlas
