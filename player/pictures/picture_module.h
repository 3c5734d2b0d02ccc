// C interface of the OpenImageIO module.
#pragma once

#include <cstddef>

namespace splatlas {

/// Interleaved pixels, floats if `is_float`, else bytes; top row first. `ending` is the file extension
/// (".exr"). The caller owns all pointers, which are used only during the call.
struct PixelsToEncode {
  const char* ending;
  int width, height, channels;
  int is_float;
  const void* pixels;
};

/// Receives all bytes of the file in one call.
using TakeBytes = void (*)(void* context, const void* bytes, std::size_t size);

/// Returns 0, or 1 with one line of text in `error`, a buffer of `error_size` bytes.
using EncodePixels = int (*)(const PixelsToEncode* pixels, TakeBytes take, void* context, char* error,
                             std::size_t error_size);

inline constexpr const char* kPictureModule = "libsplatlas_pictures.so";
inline constexpr const char* kEncodePixelsName = "splatlas_encode_pixels";

}  // namespace splatlas
