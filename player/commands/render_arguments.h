// Command line of splatlas-player render.
#pragma once

#include "player/commands/render_command.h"

namespace CLI {
class App;
}

namespace splatlas {

/// Adds the command. Parsing fills `request`, which must outlive `app`. Invalid values throw
/// CLI::ValidationError with option, value and remedy.
CLI::App* add_render(CLI::App& app, RenderRequest& request);

}  // namespace splatlas
