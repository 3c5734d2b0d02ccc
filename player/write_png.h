// PNG encoder and writer.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

#include "format/content/color.h"
#include "format/result.h"
#include "player/picture.h"

namespace splatlas {

/// kUsage, with a remedy, for pictures that encode_png() cannot take: 2^32 bytes of pixels or more. Only
/// 32768 x 32768 pixels with alpha reach that limit.
[[nodiscard]] Result<void> check_png_size(const PictureSize& size, bool alpha);

/// Encodes an 8-bit sRGB PNG: composited over `background`, or with straight alpha without one.
/// `picture.rgba` must match `picture.size`. kFailed for an empty picture and kLimit when out of memory, with
/// libpng's message. Takes at most picture_bytes() in addition to the picture. O(pixels), thread-safe.
[[nodiscard]] Result<std::vector<std::byte>> encode_png(const Picture& picture,
                                                        std::optional<Rgb> background = std::nullopt);

/// Encodes the numbers of an id image as a PNG with 16 bits of grey. The same errors.
[[nodiscard]] Result<std::vector<std::byte>> encode_png(const IdImage& ids);

/// Encodes a picture and replaces `path` atomically: it holds the old or the complete new file. Errors of
/// encode_png(), and kFailed if it cannot be written, with the file. Thread-safe for different paths.
[[nodiscard]] Result<void> write_png(const Picture& picture, const std::filesystem::path& path,
                                     std::optional<Rgb> background = std::nullopt);

}  // namespace splatlas
