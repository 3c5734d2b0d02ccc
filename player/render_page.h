// Annotated pages: a selection fitted, rendered and annotated for print or a slide.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "player/camera_moves.h"
#include "player/page/annotation.h"
#include "player/renderer.h"

namespace splatlas {

/// Minimum and maximum resolution of a printed page.
inline constexpr double kMinDpi = 72, kMaxDpi = 2400;

/// Picture and annotations of a page.
struct PageOptions {
  bool fits_selection = true;  ///< false: the whole atlas, without room for annotations
  RenderOptions render = {};
  std::optional<Rgb> background = Rgb{0, 0, 0};  ///< none: transparent
  /// At the bottom of a vertical gradient from `background`; none: the same.
  std::optional<Rgb> background_bottom = std::nullopt;
  bool outlines = false;       ///< dark lines around structures
  AnnotationItems items = {};  ///< none: a plain picture
  /// Labels of the largest structures. Not set: 40, and a note counts the others.
  std::optional<std::size_t> max_labels = std::nullopt;
  std::vector<StructureIndex> bearers =
      {};  ///< of labels, see label_bearers(); empty: every structure its own
  std::optional<std::string> caption = std::nullopt;  ///< not set: the title of the atlas
  /// Pixels per inch in print. Not set: the short side has 160 mm, but labels have at least 11 pixels.
  std::optional<double> dpi = std::nullopt;
  std::filesystem::path font = {};  ///< file to prefer to Liberation Sans and DejaVu Sans; empty: none
};

/// A rendered page.
struct Page {
  Frame frame;
  Camera camera;                ///< of the frame
  AnnotationLayer annotations;  ///< not drawn into the frame's picture
};

/// Renders pages for one kind of picture file, and encodes them. Loads the libraries for text and files in
/// the background: OpenImageIO depends on about 260 others, which take 0.2 s, longer than most pictures.
class PageRenderer {
 public:
  /// Prepares for a file of this name (see write_picture()); writes nothing. kUsage for an unknown extension
  /// and for pictures that the format cannot hold; kFailed if the font is no file.
  [[nodiscard]] static Result<PageRenderer> create(const std::filesystem::path& path, PageOptions options);
  PageRenderer(PageRenderer&&) noexcept = default;
  PageRenderer& operator=(PageRenderer&&) noexcept = default;

  /// Replaces the caption of the options.
  void set_caption(std::string caption);
  /// Replaces cuts and bearers of the options.
  void set_framing(const SceneFraming& framing);

  /// The camera of a page (see render()). Errors of render().
  [[nodiscard]] Result<Camera> fit(Renderer& renderer, const Camera& camera);
  /// Renders the renderer's selection. Unless the camera is `fitted`, fits it to the space that the
  /// annotations leave: for labels and a legend, a small draft finds the visible structures first. The
  /// camera's zoom multiplies that of the fit; its centre, if any, replaces the fit's. Adds to the notes of
  /// the annotations what the page lacks. Errors of Renderer::fit() and render(); kUsage if the product of
  /// the zooms is beyond the limits or the picture too small for its annotations; kFailed for fonts, modules.
  [[nodiscard]] Result<Page> render(Renderer& renderer, const Camera& camera,
                                    const RenderControl& control = {}, bool fitted = false);
  /// The bytes of the file. Draws the annotations into the picture of `page`, except in .svg and .pdf, which
  /// hold them as vectors. kFailed for errors of modules and their libraries. Memory: see write_picture().
  [[nodiscard]] Result<std::vector<std::byte>> encode(Page& page);
  /// Adds the page with these texts to a PDF document, whose bytes it returns with the last page. Comes ahead
  /// of encode(), which draws the annotations. Notes letters that no font has. Errors of encode().
  [[nodiscard]] Result<std::vector<std::byte>> encode_in_document(Page& page, const PageTexts& texts,
                                                                  bool is_last);

 private:
  struct Impl;
  explicit PageRenderer(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}
  std::shared_ptr<Impl> impl_;
};

}  // namespace splatlas
