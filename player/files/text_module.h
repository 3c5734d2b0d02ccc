// C++ interface of the module for text and PDF. Module and program are built together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "format/result.h"
#include "player/camera.h"
#include "player/page/annotation.h"

namespace splatlas {

/// Coverage of a text's pixels, from 0 to 1. Pixel (0, 0) is at (left, top) in the picture.
struct TextCoverage {
  int left = 0, top = 0, width = 0, height = 0;
  std::vector<float> coverage;
};

/// One page: a picture with annotations over it.
struct PdfPage {
  PictureSize size;
  double dpi = 300;
  std::vector<std::uint8_t> rgba;  ///< 8-bit sRGB with straight alpha; top row first
  std::string title;
  const AnnotationLayer* layer = nullptr;
  PageTexts texts = {};  ///< cut off where they are too long; without a heading the page is the picture
  bool is_last = true;
};

/// Text shaped by Pango and drawn by Cairo: any script, in both directions, without hinting, so that all
/// sizes have the same proportions. Other fonts stand in for missing glyphs. Not thread-safe.
class TextEngine {
 public:
  virtual ~TextEngine() = default;
  /// Width of a line at `size` pixels per em.
  [[nodiscard]] virtual double width(std::string_view text, double size, FontStyle style) = 0;
  /// True if no font has a glyph for one of the characters.
  [[nodiscard]] virtual bool lacks_glyphs(std::string_view text) = 0;
  /// Coverage of one text. kFailed if its glyphs are too large to draw.
  [[nodiscard]] virtual Result<TextCoverage> draw(const PlacedText& text) = 0;
  /// Adds a page to a PDF document. The document's bytes with its last page; nothing before. kFailed if it
  /// cannot be made. Memory: four bytes a pixel, and the compressed document.
  [[nodiscard]] virtual Result<std::vector<std::byte>> encode_pdf(const PdfPage& page) = 0;
};

/// `font`: a file to prefer to Liberation Sans and DejaVu Sans; empty: none. kFailed without a usable font.
using OpenedTextEngine = Result<std::unique_ptr<TextEngine>>;
using OpenTextEngine = void (*)(const std::string& font, OpenedTextEngine& engine);

inline constexpr const char* kTextModule = "libsplatlas_text.so";
inline constexpr const char* kOpenTextEngineName = "splatlas_open_text_engine";

}  // namespace splatlas
