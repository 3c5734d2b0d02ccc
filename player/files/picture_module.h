// C interface of the OpenImageIO module.
#pragma once

#include <cstddef>

namespace splatlas {

/// Types of channels: 8-bit sRGB, linear floats, 32-bit structure numbers ("id"), or depths ("Z", floats).
enum PixelType : int { kBytePixels = 0, kFloatPixels = 1, kNumberPixels = 2, kDepthPixels = 3 };

/// Interleaved pixels of a PixelType, top row first. `ending` is the file extension
/// (".exr"). The caller owns all pointers, which are used only during the call.
struct PixelsToEncode {
  const char* ending;
  int width, height, channels;
  int type;
  const void* pixels;
  double dpi;  ///< pixels per inch in print; 0: not stored
};

/// Receives all bytes of the file in one call.
using TakeBytes = void (*)(void* context, const void* bytes, std::size_t size);

/// Called now and then. True ends the work with an undefined result.
using IsStopped = bool (*)();

/// Returns 0, or 1 with one line of text in `error`, a buffer of `error_size` bytes.
using EncodePixels = int (*)(const PixelsToEncode* pixels, TakeBytes take, void* context,
                             IsStopped is_stopped, char* error, std::size_t error_size);

inline constexpr const char* kPictureModule = "libsplatlas_pictures.so";
inline constexpr const char* kEncodePixelsName = "splatlas_encode_pixels";

}  // namespace splatlas
