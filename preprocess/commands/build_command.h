// Command splatlas-preprocess build: an atlas from volumes, labels, names, trees and surfaces.
#pragma once

#include <string>

#include "preprocess/build_atlas.h"
#include "preprocess/commands/progress_display.h"

namespace CLI {
class App;
}

namespace splatlas {

/// Arguments of the build command.
struct BuildRequest {
  BuildOptions options;
  ProgressMode progress = automatic_progress(stderr);
};

/// Adds the command. Parsing fills `request`, which must outlive `app`. Invalid values throw
/// CLI::ValidationError with option, value and remedy.
CLI::App* add_build(CLI::App& app, BuildRequest& request);

/// Builds an atlas. Prints progress and notes to standard error, and a summary to standard output.
[[nodiscard]] Result<void> run_build(const BuildRequest& request);

}  // namespace splatlas
