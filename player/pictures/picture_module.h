// The C boundary of the module that holds OpenImageIO.
#pragma once

#include <cstddef>

namespace splatlas {

/// Pixels to a file: `channels` interleaved, floats when `is_float`, else bytes; rows top to bottom. The
/// format is that of `ending` (".exr"). Returns 0, or 1 with one line of text in `error`.
using WritePixels = int (*)(const char* path, const char* ending, int width, int height, int channels,
                            int is_float, const void* pixels, char* error, std::size_t error_size);

inline constexpr const char* kPictureModule = "libsplatlas_pictures.so";
inline constexpr const char* kWritePixelsName = "splatlas_write_pixels";

}  // namespace splatlas
