// Layout of a picture's annotations.
#pragma once

#include "format/result.h"
#include "player/camera.h"
#include "player/page/annotation.h"
#include "player/page/page_layout.h"

namespace splatlas {

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
