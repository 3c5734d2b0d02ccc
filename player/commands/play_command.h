// Command splatlas-player ATLAS: serves the page with the native engine, and opens it in the browser.
#pragma once

#include <cstdint>
#include <filesystem>

#include "format/atlas_reader.h"
#include "format/result.h"
#include "player/render_options.h"

namespace CLI {
class App;
}

namespace splatlas {

/// Arguments of the command.
struct PlayRequest {
  std::filesystem::path atlas;
  RendererOptions renderer;
  AtlasOptions atlas_options;
  std::uint16_t port = 0;  ///< 0: any
  bool no_browser = false;
};

/// Adds the options. Parsing fills `request`, which must outlive `app`.
void add_play(CLI::App& app, PlayRequest& request);

/// Prints the address, and serves until ten seconds after the last page has closed, or until SIGINT, SIGTERM
/// or SIGHUP. kInvalidAtlas at the end if pictures lacked damaged parts. Call it on the main thread, before
/// others start.
[[nodiscard]] Result<void> play(const PlayRequest& request);

}  // namespace splatlas
