// Compression of pixels with zlib, in pieces.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <span>

#include "format/result.h"

namespace splatlas {

enum class DeflateWrapper { kZlib, kGzip };

/// Compresses the concatenated `parts` into one stream with zlib's `level`, 1 to 9, and calls `write` with
/// its pieces, in order. Stops at the first error of `write` and returns it; kLimit, with `path`, when out of
/// memory. Cost: one pass, 256 KiB of memory.
[[nodiscard]] Result<void> deflate_in_pieces(
    std::initializer_list<std::span<const std::byte>> parts, DeflateWrapper wrapper, int level,
    const std::filesystem::path& path, const std::function<Result<void>(std::span<const std::byte>)>& write);

}  // namespace splatlas
