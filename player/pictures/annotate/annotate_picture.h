// Layout of a picture's annotations.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "format/color.h"
#include "format/result.h"
#include "player/camera.h"
#include "player/picture.h"
#include "player/pictures/annotate/annotation.h"
#include "player/pictures/annotate/visible_structures.h"

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

/// Minimum and maximum resolution of a printed picture.
inline constexpr double kMinDpi = 72, kMaxDpi = 2400;

/// Content of the annotations.
struct AnnotationOptions {
  AnnotationItems items = {};
  std::size_t max_labels = 40;  ///< labels of the largest structures
  std::string caption = {}, citation = {};
  /// Pixels per inch in print. Not set: the short side has 160 mm, but labels at least 11 pixels.
  std::optional<double> dpi = std::nullopt;
};

/// Pixels per inch: that of the options, or a default that depends on the size.
[[nodiscard]] double annotation_dpi(const AnnotationOptions& options, const PictureSize& size);

/// Places the annotations. Texts have 7 to 13 points in print and lie inside the picture. Labels cover no
/// structure (see place_labels()). Other items leave structures free where they can; `notes` names those that
/// cannot. kUsage, with a remedy, if the picture is too small. O(pixels + labels^3).
[[nodiscard]] Result<AnnotationLayer> annotate_picture(const AnnotatedScene& scene,
                                                       const AnnotationOptions& options,
                                                       const MeasureText& measure);

/// Region of a picture for its structures, so that the annotations find room beside them. Takes the size of
/// the picture, not its pixels, and the names and visible areas of the structures. The region has at least a
/// fifth of the picture's width and height.
[[nodiscard]] PictureRegion region_of_figure(const AnnotatedScene& scene, const AnnotationOptions& options,
                                             const MeasureText& measure);

}  // namespace splatlas
