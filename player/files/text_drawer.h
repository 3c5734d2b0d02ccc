// Text of pages, through the module with Pango and Cairo.
#pragma once

#include <cstddef>
#include <filesystem>
#include <future>
#include <memory>
#include <string_view>
#include <vector>

#include "format/result.h"
#include "player/files/text_module.h"
#include "player/page/annotation.h"

namespace splatlas {

/// Measures and draws text, and writes PDF. Not thread-safe.
class TextDrawer {
 public:
  /// Begins to load the module and the fonts. `font`: a file to prefer to those of the system; empty: none.
  explicit TextDrawer(const std::filesystem::path& font);

  /// Waits for the module. kFailed if it cannot be loaded, or without a usable font.
  [[nodiscard]] Result<void> wait();

  // After wait():

  /// Width of a line at `size` pixels per em.
  [[nodiscard]] double width(std::string_view text, double size, FontStyle style) const;
  /// True if no font has a glyph for one of the characters.
  [[nodiscard]] bool lacks_glyphs(std::string_view text) const;
  /// Coverage of one text. kFailed with the reason.
  [[nodiscard]] Result<TextCoverage> draw(const PlacedText& text) const;
  /// Adds a page to a PDF document, whose bytes it returns with the last page. kFailed with the reason.
  [[nodiscard]] Result<std::vector<std::byte>> encode_pdf(const PdfPage& page) const;

 private:
  using Engine = std::unique_ptr<TextEngine>;
  std::future<Result<Engine>> opening_;
  Result<Engine> opened_;
};

}  // namespace splatlas
