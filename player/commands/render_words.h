// The command line of splatlas-player render.
#pragma once

#include <string>

#include "format/result.h"
#include "player/commands/render_command.h"

namespace CLI {
class App;
}

namespace splatlas {

/// What is typed, as text: checked here rather than by CLI11, so that every message says what to do.
struct RenderWords {
  std::string atlas, output, select = "*", stats;
  std::string size = "512x512", quality = "normal", projection = "parallel", shading = "hybrid";
  std::string field_of_view = "30", classify = "before", depth_cue = "none";
  std::string view, azimuth, elevation, zoom = "1";
  std::string background = "#000000", threads = "0";
};

/// Adds the command; parsing fills `words`, which must live as long as `app`.
CLI::App* add_render(CLI::App& app, RenderWords& words);

/// kUsage, naming the option, for words that say nothing.
[[nodiscard]] Result<RenderRequest> render_request(const CLI::App& command, const RenderWords& words);

/// 0 to 1024.
[[nodiscard]] Result<unsigned> parse_threads(const std::string& text);

}  // namespace splatlas
