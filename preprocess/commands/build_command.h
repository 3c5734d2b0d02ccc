// Command splatlas-preprocess build: an atlas from volumes, labels, names, trees and surfaces.
#pragma once

#include <string>

#include "preprocess/build_atlas.h"
#include "preprocess/commands/progress_display.h"

namespace CLI {
class App;
}

namespace splatlas {

/// Everything that the command line of build says.
struct BuildRequest {
  BuildOptions options;
  ProgressMode progress = automatic_progress(stderr);
};

/// Adds the command. Parsing fills `request`, which must live as long as `app`; invalid values throw
/// CLI::ValidationError, which names option, value and remedy.
CLI::App* add_build(CLI::App& app, BuildRequest& request);

/// Builds; progress and notes go to standard error, a summary to standard output.
[[nodiscard]] Result<void> run_build(const BuildRequest& request);

}  // namespace splatlas
