// Runs of both programs.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/run_program.h"

namespace splatlas {

using Words = std::vector<std::string>;

[[nodiscard]] inline Words joined(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

[[nodiscard]] inline ProgramResult run_player(
    const Words& words, const std::filesystem::path& folder = std::filesystem::current_path()) {
  return run_program(joined({SPLATLAS_PLAYER}, words), folder);
}
[[nodiscard]] inline ProgramResult run_preprocess(const Words& words, const std::filesystem::path& folder) {
  return run_program(joined({SPLATLAS_PREPROCESS}, words), folder);
}

/// A script for run_by_shell().
inline constexpr const char* kFullDevice = R"(exec "$0" "$@" >/dev/full)";
/// The shell runs `script`, which replaces it by the program `words[0]`.
[[nodiscard]] inline ProgramResult run_by_shell(const char* script, const Words& words,
                                                const std::filesystem::path& folder) {
  return run_program(joined({"/bin/sh", "-c", script}, words), folder);
}

}  // namespace splatlas
