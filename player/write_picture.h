// Picture files of every format.
#pragma once

#include <filesystem>
#include <optional>

#include "format/content/color.h"
#include "format/result.h"
#include "player/picture.h"

namespace splatlas {

/// Writes a picture as .png, .jpg, .tif (8-bit sRGB), .exr (float, linear, premultiplied), .svg or .pdf.
/// Composites over `background`, or keeps alpha without one (JPEG is then over black). EXR always keeps
/// alpha. Replaces the file whole, or leaves the one before. kUsage for other extensions and for pictures
/// that the format cannot hold; kFailed if the file cannot be written, or if a module cannot be loaded:
/// OpenImageIO writes .jpg, .tif and .exr, Cairo .pdf. Memory: at most picture_bytes() in addition to the
/// picture; documents take twice as much.
[[nodiscard]] Result<void> write_picture(const Picture& picture, const std::filesystem::path& path,
                                         std::optional<Rgb> background = std::nullopt);

}  // namespace splatlas
