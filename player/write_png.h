// Pictures to PNG files.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

#include "format/color.h"
#include "format/result.h"
#include "player/picture.h"

namespace splatlas {

/// kUsage, saying what to do, for a picture with more pixels than encode_png() can take: with alpha 2^32
/// bytes of them are too many, which 32768 x 32768 pixels have.
[[nodiscard]] Result<void> check_png_size(const PictureSize& size, bool alpha);

/// The bytes of an 8-bit sRGB PNG: over `background`, or with alpha where there is none. `picture.rgba` holds
/// what `picture.size` says. kFailed, with libpng's words, when it cannot be encoded. Takes at most
/// picture_bytes() beside the picture. Safe to call from several threads.
[[nodiscard]] Result<std::vector<std::byte>> encode_png(const Picture& picture,
                                                        std::optional<Rgb> background = std::nullopt);

/// Encodes a picture and writes the file: `path` is the old file or the complete new one, never anything
/// else. kFailed, naming the file, when it cannot be encoded or written.
[[nodiscard]] Result<void> write_png(const Picture& picture, const std::filesystem::path& path,
                                     std::optional<Rgb> background = std::nullopt);

}  // namespace splatlas
