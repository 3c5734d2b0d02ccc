// Measures and draws text through the OpenImageIO module (FreeType).
#pragma once

#include <array>
#include <filesystem>
#include <future>
#include <string_view>
#include <vector>

#include "format/result.h"
#include "player/page/annotation.h"

namespace splatlas {

/// Font files by FontStyle.
using FontFiles = std::array<std::filesystem::path, kFontStyles>;

/// Finds Liberation Sans or DejaVu Sans of Debian's packages, in this order. `chosen`, if not empty, is used
/// for all styles instead. kFailed, with the packages, if there is no font; kFailed if `chosen` is no file.
/// `root` is the folder with the fonts.
[[nodiscard]] Result<FontFiles> find_fonts(const std::filesystem::path& chosen,
                                           const std::filesystem::path& root = "/usr/share/fonts/truetype");

/// Coverage of a text's pixels, from 0 to 1. Pixel (0, 0) is at (left, top) in the picture.
struct TextCoverage {
  int left = 0, top = 0, width = 0, height = 0;
  std::vector<float> coverage;
};

/// Measures and draws text. Glyphs are drawn at four times their size and averaged: their widths and
/// positions then match those of unhinted vector text within a quarter of a pixel.
class TextDrawer {
 public:
  /// Begins to load the module, unless `fonts` are empty.
  explicit TextDrawer(FontFiles fonts);

  /// Waits for the module. kFailed if it or a font cannot be loaded.
  [[nodiscard]] Result<void> wait();
  /// Width of a line at `size` pixels per em; 0 if it cannot be measured. After wait().
  [[nodiscard]] double width(std::string_view text, double size, FontStyle style) const;
  /// Coverage of one text. kFailed with the reason. After wait().
  [[nodiscard]] Result<TextCoverage> draw(const PlacedText& text) const;

 private:
  FontFiles fonts_;
  std::future<Result<void*>> module_;
  void* function_ = nullptr;
};

}  // namespace splatlas
