// Runs of both programs, and the golden phantom, built through the command line.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/phantom/phantom_files.h"
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

/// phantom.atlas and its source files, in a folder that is removed when the program ends.
inline const TemporaryFolder& phantom_folder() {
  static const TemporaryFolder folder;
  static const bool built = [] {
    EXPECT_TRUE(phantom::write_files(folder.path()));
    const ProgramResult build =
        run_preprocess({"build", "-o", "phantom.atlas", "--labels", "labels.nrrd", "--volume", "volume.nrrd",
                        "--names", "names.txt", "--tree", "phantom.tree", "--progress", "none"},
                       folder.path());
    EXPECT_EQ(build.status, 0) << build.err;
    return build.status == 0;
  }();
  EXPECT_TRUE(built);
  return folder;
}

inline std::string phantom_atlas() {
  return phantom_folder().file("phantom.atlas");
}

}  // namespace splatlas
