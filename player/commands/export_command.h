// Command splatlas-player export: atlases to pages for browsers.
#pragma once

#include <filesystem>
#include <vector>

#include "format/result.h"
#include "player/commands/framing.h"

namespace CLI {
class App;
}

namespace splatlas {

/// Arguments of the export command.
struct ExportRequest {
  std::vector<std::filesystem::path> atlases;  ///< one, unless `site` is given
  std::filesystem::path html, site;            ///< one of them
  OpeningRequest opening;
};

/// Adds the command. Parsing fills `request`, which must outlive `app`. Invalid values throw
/// CLI::ValidationError with option, value and remedy.
CLI::App* add_export(CLI::App& app, ExportRequest& request);

/// Writes the page, or the folder of the site: all of it, or nothing. Refuses damaged atlases. Errors name
/// the file.
[[nodiscard]] Result<void> run_export(const ExportRequest& request);

}  // namespace splatlas
