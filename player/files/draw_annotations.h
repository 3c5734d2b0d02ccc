// Annotations drawn into the pixels of a picture, or beside it in an SVG document; modules that are loaded at
// run time, and the engine of texts in one of them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <future>
#include <optional>
#include <span>
#include <string>

#include "format/content/color.h"
#include "format/result.h"
#include "player/camera.h"
#include "player/files/text_module.h"
#include "player/page/annotation.h"
#include "player/picture.h"

namespace splatlas {

/// Loads a module and finds a function. Modules are never unloaded. kFailed with the reason; `library` names
/// the module's main dependency. Thread-safe.
[[nodiscard]] Result<void*> load_function(const char* module, const char* function, const char* library);

/// The text engine, which is loaded in the background. Not thread-safe.
class TextDrawer {
 public:
  /// Begins to load the module and the fonts. `font`: a file to prefer to those of the system; empty: none.
  explicit TextDrawer(const std::filesystem::path& font);

  /// Waits for the module. kFailed if it cannot be loaded, or without a usable font.
  [[nodiscard]] Result<void> wait();
  /// After wait().
  [[nodiscard]] TextEngine* operator->() const { return opened_->get(); }

 private:
  std::future<OpenedTextEngine> opening_;
  OpenedTextEngine opened_;
};

/// Writes an SVG 1.1 document in pixels, whose page has the size of the picture at `dpi`. `png` is embedded,
/// texts stay texts in sans-serif fonts, and their widths are those of the layout in any font.
[[nodiscard]] std::string svg_document(std::span<const std::byte> png, const PictureSize& size, double dpi,
                                       const AnnotationLayer& layer);

/// Draws a layer over a picture, antialiased. Covered pixels are composited over `background`, if there is
/// one, and mixed in sRGB, so that dark and light strokes look equally thick. All others keep their bits.
/// kFailed if a text cannot be drawn; the picture is then unchanged. `drawer`: ready, for a layer with texts.
/// O(pixels of the annotations).
[[nodiscard]] Result<void> draw_annotations(Picture& picture, const AnnotationLayer& layer,
                                            std::optional<Rgb> background, const TextDrawer* drawer);

/// Share of the pixel (x, y) that a stroke covers: from 0 to 1, by the distances to its sides and ends.
[[nodiscard]] double stroke_coverage(const PlacedLine& line, double width, int x, int y);

}  // namespace splatlas
