// `splatlas-preprocess export`.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "preprocess/export/export_atlas.h"

namespace splatlas {

/// What CLI11 collects.
struct ExportWords {
  ExportOptions options;
  std::vector<std::string> surfaces;
};

/// Adds the command to `app`, which fills `words` when it parses.
void add_export(CLI::App& app, ExportWords& words);

/// Exports, and prints a line per file on standard output.
[[nodiscard]] Result<void> run_export(const ExportWords& words);

}  // namespace splatlas
