// Options of annotations.
#pragma once

#include "player/render_page.h"

namespace CLI {
class App;
}

namespace splatlas {

/// Adds the options. Parsing fills `options`, which must outlive the command. Errors are those of
/// add_render().
void add_annotations(CLI::App& command, PageOptions& options);

}  // namespace splatlas
