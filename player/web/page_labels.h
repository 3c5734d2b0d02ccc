// Names with leader lines on the picture of a page.
#pragma once

#include <nlohmann/json.hpp>

#include "format/result.h"
#include "player/camera.h"
#include "player/renderer.h"

namespace splatlas {

/// Places names on a frame of this camera, as on a printed page (annotate_picture()). The request has
/// {glyphs: {letter: width in em}, dpi, background: "#rrggbb", labels: [name, ...]}; without labels, what is
/// not a ghost gets a name. The answer has {lines: [[x0, y0, x1, y1, width, color, casing, casing color],
/// ...], dots: [[x, y, radius, color, casing, casing color], ...], texts: [[text, x, baseline, size, color],
/// ...]}, in pixels. kNotFound for unknown names; kUsage for a picture that is too small.
[[nodiscard]] Result<nlohmann::ordered_json> page_labels(const nlohmann::ordered_json& request,
                                                         const Frame& frame, const Camera& camera,
                                                         const Renderer& renderer);

}  // namespace splatlas
