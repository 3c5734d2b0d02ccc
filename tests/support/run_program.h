// Child processes of tests, with their output.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.h"

namespace splatlas {

struct ProgramResult {
  int status = -1;  ///< exit status; 128 + signal number if a signal ended it
  std::string out, err;
  double cpu_seconds = 0;
  std::uint64_t peak_bytes = 0;  ///< resident memory, that of this process at the fork included
};

/// Runs `words[0]` with the other words as arguments, without a shell, in `folder`. `meanwhile` is called
/// with the process id before it is waited for. `before` is called in the child, right before exec.
[[nodiscard]] ProgramResult run_program(const std::vector<std::string>& words,
                                        const std::filesystem::path& folder = std::filesystem::current_path(),
                                        const std::function<void(int)>& meanwhile = {},
                                        const std::function<void()>& before = {});

}  // namespace splatlas
