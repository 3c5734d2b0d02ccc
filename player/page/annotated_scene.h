// Picture to annotate, and content of its annotations.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "format/content/color.h"
#include "player/camera.h"
#include "player/page/annotation.h"
#include "player/page/visible_structures.h"
#include "player/picture.h"

namespace splatlas {

/// A visible structure with its name and colour.
struct NamedStructure {
  std::string name;
  Rgb color;
  VisibleStructure visible;
};

/// A picture to annotate.
struct AnnotatedScene {
  const Picture& picture;
  View view;
  std::optional<Rgb> background = std::nullopt;  ///< none: transparent, annotated as a white one
  std::vector<NamedStructure> structures = {};  ///< of labels and legend; entries of the legend in this order
};

/// Content of the annotations.
struct AnnotationOptions {
  AnnotationItems items = {};
  std::size_t max_labels = 40;  ///< labels of the largest structures
  std::string caption = {}, citation = {};
  /// Pixels per inch in print. Not set: the short side has 160 mm, but labels at least 11 pixels.
  std::optional<double> dpi = std::nullopt;
};

}  // namespace splatlas
