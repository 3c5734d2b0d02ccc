// SVG document: a picture with vector annotations.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "player/camera.h"
#include "player/page/annotation.h"

namespace splatlas {

/// Writes an SVG 1.1 document in pixels, whose page has the size of the picture at `dpi`. `png` is embedded,
/// texts stay texts in sans-serif fonts, and their widths are those of the layout in any font.
[[nodiscard]] std::string svg_document(std::span<const std::byte> png, const PictureSize& size, double dpi,
                                       const AnnotationLayer& layer);

}  // namespace splatlas
