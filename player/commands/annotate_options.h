// Options of annotations.
#pragma once

#include <string_view>

#include "player/render_page.h"

namespace CLI {
class App;
}

namespace splatlas {

/// Adds the options. Parsing fills `options`, which must outlive the command. Errors are those of
/// add_render().
void add_annotations(CLI::App& command, PageOptions& options);

/// Parses a list of items: "labels,legend". kUsage, with the valid names.
[[nodiscard]] Result<AnnotationItems> parse_annotations(std::string_view text);

}  // namespace splatlas
