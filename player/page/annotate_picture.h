// Layout of a picture's annotations.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "format/content/selection.h"
#include "format/result.h"
#include "player/camera.h"
#include "player/page/annotation.h"
#include "player/page/page_layout.h"

namespace splatlas {

/// A text as one printable line, cut off if it is too long to lay out.
[[nodiscard]] std::string printed_line(std::string_view text);
/// The same with its line feeds.
[[nodiscard]] std::string printed_lines(std::string_view text);

/// The structures in a picture of a selection, in the order of the tree, with blanks for underscores.
/// `bearers`: see label_bearers(): structures with the same one are one, and those without have no label;
/// empty: all have their own. Cost: 40 000 calls of `at`.
[[nodiscard]] std::vector<NamedStructure> named_structures(const Picture& picture, const StructureAt& at,
                                                           const StructureGraph& graph,
                                                           const Selection& selection,
                                                           const std::vector<StructureIndex>& bearers);

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
