// What the harnesses that count points have in common.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace splatlas {

/// Which of all points are taken: the first, and each so-many-th after it, in what has `only` in its name.
struct ChosenPoints {
  std::uint64_t every = 1, first = 0;
  std::string only;
};

/// Reads --every, --first and --only, and runs; the program's exit status.
[[nodiscard]] int run_harness(int argc, char** argv, const std::string& name, const std::string& what,
                              const std::function<int(const ChosenPoints&)>& run);

}  // namespace splatlas
