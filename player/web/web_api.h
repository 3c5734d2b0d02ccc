// PageEngine as C functions, for a page's script: splatlas.js calls them.
//
// A module has one engine. An answer, a picture and the input are valid until the next call. Not thread-safe.
#pragma once

#include <cstdint>

#ifdef __wasm__
#define SPLATLAS_WEB(name) extern "C" __attribute__((export_name(#name), used))
#else  // for tools that read the source
#define SPLATLAS_WEB(name) extern "C"
#endif

/// Makes room for the input of the next call: bytes, and behind them the request in UTF-8. Null when out of
/// memory.
SPLATLAS_WEB(splatlas_input) std::uint8_t* splatlas_input(std::uint32_t bytes);
/// Answers the request, the last bytes of the input. Returns PageAnswer::status.
SPLATLAS_WEB(splatlas_call) int splatlas_call(std::uint32_t request_bytes);
/// The latest answer's text, in UTF-8, and its bytes.
SPLATLAS_WEB(splatlas_text) const char* splatlas_text();
SPLATLAS_WEB(splatlas_text_bytes) std::uint32_t splatlas_text_bytes();
/// The picture: linear RGBA, premultiplied; 4 * width * height floats, top row first.
SPLATLAS_WEB(splatlas_floats) const float* splatlas_floats();
/// The same as 8-bit sRGB with straight alpha, for ImageData. Null when out of memory.
SPLATLAS_WEB(splatlas_pixels) const std::uint8_t* splatlas_pixels();
