// C interface of the OpenImageIO module.
#pragma once

#include <cstddef>

namespace splatlas {

/// Types of channels: 8-bit sRGB, linear floats, 32-bit numbers of structures ("id"), or depths ("Z",
/// floats).
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

/// Returns 0, or 1 with one line of text in `error`, a buffer of `error_size` bytes.
using EncodePixels = int (*)(const PixelsToEncode* pixels, TakeBytes take, void* context, char* error,
                             std::size_t error_size);

/// One line of UTF-8 text in a font file, at a size in whole pixels per em.
struct TextToDraw {
  const char* text;
  const char* font;
  int size;
};

/// Extents of a text's ink, in pixels from its origin on the baseline; y grows downwards.
struct TextExtents {
  int left, top, right, bottom;
};

/// Receives the coverage of the text's ink, from 0 to 1, top row first, in one call.
using TakeCoverage = void (*)(void* context, const TextExtents* extents, const float* coverage);

/// Measures a text, and draws it if `take` is not null. Returns 0, or 1 with one line of text in `error`.
using DrawText = int (*)(const TextToDraw* text, TextExtents* extents, TakeCoverage take, void* context,
                         char* error, std::size_t error_size);

inline constexpr const char* kPictureModule = "libsplatlas_pictures.so";
inline constexpr const char* kEncodePixelsName = "splatlas_encode_pixels";
inline constexpr const char* kDrawTextName = "splatlas_draw_text";

}  // namespace splatlas
