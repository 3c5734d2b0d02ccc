// The figures of the gallery: scripts/gallery.tsv, which the demo renders, is what the benches measure.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "format/result.h"
#include "player/camera.h"

namespace splatlas {

struct Figure {
  std::string name;       ///< the paper's: "5a"
  std::string atlas;      ///< "phantom" or "colin27"
  Camera camera;          ///< where the picture of the gallery is taken from
  std::string selection;  ///< selection text
};

/// The figures of one atlas, in the order of the file. kFailed names file and line of what cannot be read,
/// and tells when there is none.
[[nodiscard]] Result<std::vector<Figure>> read_gallery(const std::filesystem::path& path,
                                                       const std::string& atlas);

/// The gallery of the source tree that this program was built from.
[[nodiscard]] Result<std::vector<Figure>> read_gallery(const std::string& atlas);

}  // namespace splatlas
