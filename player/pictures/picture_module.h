// The C boundary of the module that holds OpenImageIO.
#pragma once

#include <cstddef>

namespace splatlas {

/// `channels` interleaved, floats when `is_float`, else bytes; rows top to bottom. The format is that of
/// `ending` (".exr"). All pointers are the caller's, and used during the call only.
struct PixelsToEncode {
  const char* ending;
  int width, height, channels;
  int is_float;
  const void* pixels;
};

/// Where the module hands the bytes of the file, all at once.
using TakeBytes = void (*)(void* context, const void* bytes, std::size_t size);

/// Returns 0, or 1 with one line of text in `error`, of `error_size` bytes.
using EncodePixels = int (*)(const PixelsToEncode* pixels, TakeBytes take, void* context, char* error,
                             std::size_t error_size);

inline constexpr const char* kPictureModule = "libsplatlas_pictures.so";
inline constexpr const char* kEncodePixelsName = "splatlas_encode_pixels";

}  // namespace splatlas
