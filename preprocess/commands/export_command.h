// Command splatlas-preprocess export: labels, volume and surfaces of an atlas.
#pragma once

#include "preprocess/export/export_atlas.h"

namespace CLI {
class App;
}

namespace splatlas {

/// Adds the command. Parsing fills `options`, which must outlive `app`. Invalid values throw
/// CLI::ValidationError with option, value and remedy.
CLI::App* add_export(CLI::App& app, ExportOptions& options);

/// Exports and prints a line per file to standard output.
[[nodiscard]] Result<void> run_export(const ExportOptions& options);

}  // namespace splatlas
