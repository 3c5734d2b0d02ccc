// Files of pictures, id images and depth maps.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

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

/// kUsage, with the supported extensions, unless `path` ends in .png or .exr.
[[nodiscard]] Result<void> check_id_ending(const std::filesystem::path& path);
/// The bytes of an id image's file: .png with 16 bits of grey, or .exr with one channel of 32-bit integers,
/// "id". kUsage for other extensions, kFailed for errors of the libraries; messages name the file. Memory: 4
/// bytes per pixel, and the file.
[[nodiscard]] Result<std::vector<std::byte>> encode_ids(const IdImage& ids,
                                                        const std::filesystem::path& path);

/// kUsage unless `path` ends in .exr.
[[nodiscard]] Result<void> check_depth_ending(const std::filesystem::path& path);
/// The bytes of a depth map's file: .exr with one channel of floats, "Z". Depths count towards the eye, and
/// background is NaN. Errors as for id images.
[[nodiscard]] Result<std::vector<std::byte>> encode_depths(const DepthMap& depths,
                                                           const std::filesystem::path& path);

}  // namespace splatlas
