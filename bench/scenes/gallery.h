// Figures of the gallery, scripts/gallery.tsv, which the demo renders and benches measure.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "format/result.h"
#include "player/camera.h"

namespace splatlas {

struct Figure {
  std::string name;       ///< number in the paper: "5a"
  std::string atlas;      ///< "phantom" or "colin27"
  Camera camera;          ///< camera of the gallery picture
  std::string selection;  ///< selection text
};

/// The figures of one atlas, in file order. kFailed names file and line of an invalid entry, or reports that
/// there are none.
[[nodiscard]] Result<std::vector<Figure>> read_gallery(const std::filesystem::path& path,
                                                       const std::string& atlas);

/// The gallery of the source tree of this build.
[[nodiscard]] Result<std::vector<Figure>> read_gallery(const std::string& atlas);

}  // namespace splatlas
