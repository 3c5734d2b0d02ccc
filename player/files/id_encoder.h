// Encoder of id images.
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "format/result.h"
#include "player/picture.h"

namespace splatlas {

/// kUsage, with the supported extensions, unless `path` ends in .png or .exr.
[[nodiscard]] Result<void> check_id_ending(const std::filesystem::path& path);

/// Encodes the numbers of an id image for a file of this name: .png with 16 bits of grey, or .exr with one
/// channel of 32-bit integers, "id". kFailed for errors of zlib and OpenImageIO; messages name the file.
/// Memory: 4 bytes per pixel.
[[nodiscard]] Result<std::vector<std::byte>> encode_ids(const IdImage& ids,
                                                        const std::filesystem::path& path);

}  // namespace splatlas
