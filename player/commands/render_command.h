// splatlas-player render: a selection of an atlas to a picture file.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "format/result.h"
#include "player/render_frame.h"

namespace splatlas {

struct RenderRequest {
  std::filesystem::path atlas, output;
  std::string select = "*";
  Camera camera;
  RenderOptions options;
  unsigned threads = 0;
  std::optional<Rgb> background = Rgb{0, 0, 0};  ///< none: transparent
  std::filesystem::path stats;                   ///< empty: none wanted
};

/// Writes the picture. Where the atlas is damaged, that of what can be read: returns what is missing from it
/// and why, a line each; nothing as a rule.
[[nodiscard]] Result<std::vector<std::string>> run_render(const RenderRequest& request);

}  // namespace splatlas
