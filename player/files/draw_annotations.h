// Annotations drawn into the pixels of a picture.
#pragma once

#include <optional>

#include "format/content/color.h"
#include "format/result.h"
#include "player/files/load_module.h"
#include "player/page/annotation.h"
#include "player/picture.h"

namespace splatlas {

/// Draws a layer over a picture, antialiased. Covered pixels are composited over `background`, if there is
/// one, and mixed in sRGB, so that dark and light strokes look equally thick. All others keep their bits.
/// kFailed if a text cannot be drawn; the picture is then unchanged. `drawer`: ready, for a layer with texts.
/// O(pixels of the annotations).
[[nodiscard]] Result<void> draw_annotations(Picture& picture, const AnnotationLayer& layer,
                                            std::optional<Rgb> background, const TextDrawer* drawer);

/// Share of the pixel (x, y) that a stroke covers: from 0 to 1, by the distances to its sides and ends.
[[nodiscard]] double stroke_coverage(const PlacedLine& line, double width, int x, int y);

}  // namespace splatlas
