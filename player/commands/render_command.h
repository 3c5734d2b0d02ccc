// Command splatlas-player render: a selection of an atlas to a picture file.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "format/result.h"
#include "player/render_frame.h"

namespace splatlas {

/// Everything that the command line of render says.
struct RenderRequest {
  std::filesystem::path atlas, output;
  std::string select = "*";
  Camera camera;
  RenderOptions options;
  unsigned threads = 0;
  std::optional<Rgb> background = Rgb{0, 0, 0};  ///< none: transparent
  std::filesystem::path stats;                   ///< JSON file; empty: none
};

/// Writes the picture, and the statistics if asked for, or neither. Of a damaged atlas, renders the intact
/// parts and returns a line for each missing one.
[[nodiscard]] Result<std::vector<std::string>> run_render(const RenderRequest& request);

}  // namespace splatlas
