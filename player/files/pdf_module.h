// C++ interface of the Cairo module. Module and program are built together.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "player/camera.h"
#include "player/page/annotation.h"

namespace splatlas {

/// One page: a picture with annotations over it.
struct PdfPage {
  PictureSize size;
  double dpi = 300;
  std::vector<std::uint8_t> rgba;              ///< 8-bit sRGB with straight alpha; top row first
  std::array<std::string, kFontStyles> fonts;  ///< files by FontStyle
  std::string title;
  const AnnotationLayer* layer = nullptr;
};

/// Appends a PDF document to `bytes`. `error` is empty after success. Throws std::bad_alloc only.
using EncodePdf = void (*)(const PdfPage& page, std::vector<std::byte>& bytes, std::string& error);

inline constexpr const char* kPdfModule = "libsplatlas_pdf.so";
inline constexpr const char* kEncodePdfName = "splatlas_encode_pdf";

}  // namespace splatlas
