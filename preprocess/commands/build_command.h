// `splatlas-preprocess build`.
#pragma once

#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "format/result.h"

namespace splatlas {

/// What CLI11 collects, checked in run_build so that every message says what to do.
struct BuildWords;
struct ForgetBuildWords {
  void operator()(BuildWords* words) const;
};
using BuildWordsPtr = std::unique_ptr<BuildWords, ForgetBuildWords>;

/// Adds the command to `app`; the words are filled when `app` parses.
[[nodiscard]] BuildWordsPtr add_build(CLI::App& app);

/// Builds, shows progress and notes on standard error and a summary on standard output. `tool` is the
/// program's name and version.
[[nodiscard]] Result<void> run_build(const BuildWords& words, const std::string& tool);

}  // namespace splatlas
