#include "player/files/pdf_module.h"

#include <cstring>
#include <memory>
#include <numbers>

#include <cairo-ft.h>
#include <cairo-pdf.h>
#include <cairo.h>
#include <ft2build.h>
#include FT_FREETYPE_H

namespace splatlas {
namespace {

template <auto destroy>
struct Destroy {
  template <typename T>
  void operator()(T* object) const {
    destroy(object);
  }
};
using Surface = std::unique_ptr<cairo_surface_t, Destroy<cairo_surface_destroy>>;
using Context = std::unique_ptr<cairo_t, Destroy<cairo_destroy>>;

/// FreeType with the fonts of a page. Cairo's faces refer to them.
class Fonts {
 public:
  ~Fonts() {
    for (cairo_font_face_t* face : faces_) cairo_font_face_destroy(face);
    for (FT_Face file : files_) {
      if (file != nullptr) FT_Done_Face(file);
    }
    if (library_ != nullptr) FT_Done_FreeType(library_);
  }
  Fonts() = default;
  Fonts(const Fonts&) = delete;
  Fonts& operator=(const Fonts&) = delete;

  /// Loads all files. Returns an error, empty for success.
  std::string load(const std::array<std::string, kFontStyles>& names) {
    if (FT_Init_FreeType(&library_) != 0) return "FreeType cannot be initialised";
    for (std::size_t n = 0; n < names.size(); ++n) {
      if (FT_New_Face(library_, names[n].c_str(), 0, &files_[n]) != 0) {
        return names[n] + ": cannot be read as a font";
      }
      faces_[n] = cairo_ft_font_face_create_for_ft_face(files_[n], FT_LOAD_NO_HINTING);
    }
    return {};
  }
  [[nodiscard]] cairo_font_face_t* operator[](FontStyle style) const {
    return faces_[static_cast<std::size_t>(style)];
  }

 private:
  FT_Library library_ = nullptr;
  std::array<FT_Face, kFontStyles> files_{};
  std::array<cairo_font_face_t*, kFontStyles> faces_{};
};

void set_color(cairo_t* cairo, Rgb color, double opacity = 1) {
  cairo_set_source_rgba(cairo, color.r / 255.0, color.g / 255.0, color.b / 255.0, opacity);
}

/// Picture as Cairo's premultiplied native-endian ARGB.
Surface image_of(const PdfPage& page) {
  bool opaque = true;
  for (std::size_t n = 3; n < page.rgba.size(); n += 4) opaque = opaque && page.rgba[n] == 255;
  Surface image(cairo_image_surface_create(opaque ? CAIRO_FORMAT_RGB24 : CAIRO_FORMAT_ARGB32, page.size.width,
                                           page.size.height));
  if (cairo_surface_status(image.get()) != CAIRO_STATUS_SUCCESS) return image;
  unsigned char* row = cairo_image_surface_get_data(image.get());
  const std::uint8_t* from = page.rgba.data();
  for (int y = 0; y < page.size.height; ++y, row += cairo_image_surface_get_stride(image.get())) {
    for (int x = 0; x < page.size.width; ++x, from += 4) {
      const std::uint32_t a = from[3];
      const auto channel = [&](int c) { return (from[c] * a + 127) / 255; };
      const std::uint32_t pixel = a << 24 | channel(0) << 16 | channel(1) << 8 | channel(2);
      std::memcpy(row + 4 * static_cast<std::size_t>(x), &pixel, sizeof(pixel));
    }
  }
  cairo_surface_mark_dirty(image.get());
  return image;
}

struct Painter {
  cairo_t* cairo;

  void box(const PlacedBox& one) const {
    set_color(cairo, one.color, one.opacity);
    cairo_rectangle(cairo, one.box.left, one.box.top, one.box.width(), one.box.height());
    cairo_fill(cairo);
  }
  void stroke(const PlacedLine& line, double width, Rgb color, double opacity) const {
    set_color(cairo, color, opacity);
    cairo_set_line_width(cairo, width);
    cairo_move_to(cairo, line.from.x, line.from.y);
    cairo_line_to(cairo, line.to.x, line.to.y);
    cairo_stroke(cairo);
  }
  void disc(PagePoint center, double radius, Rgb color, double opacity) const {
    set_color(cairo, color, opacity);
    cairo_arc(cairo, center.x, center.y, radius, 0, 2 * std::numbers::pi);
    cairo_fill(cairo);
  }
};

void draw_layer(cairo_t* cairo, const AnnotationLayer& layer, const Fonts& fonts) {
  const Painter painter{cairo};
  paint_shapes(layer, painter);
  for (const PlacedText& one : layer.texts) {
    set_color(cairo, one.color);
    cairo_set_font_face(cairo, fonts[one.style]);
    cairo_set_font_size(cairo, one.size);
    cairo_move_to(cairo, one.x, one.y);
    cairo_show_text(cairo, one.text.c_str());
  }
}

cairo_status_t append(void* to, const unsigned char* data, unsigned length) {
  auto* const bytes = static_cast<std::vector<std::byte>*>(to);
  const auto* const first = reinterpret_cast<const std::byte*>(data);
  bytes->insert(bytes->end(), first, first + length);
  return CAIRO_STATUS_SUCCESS;
}

}  // namespace
}  // namespace splatlas

extern "C" __attribute__((visibility("default"))) void splatlas_encode_pdf(const splatlas::PdfPage& page,
                                                                           std::vector<std::byte>& bytes,
                                                                           std::string& error) {
  splatlas::Fonts fonts;
  if (!page.layer->texts.empty()) error = fonts.load(page.fonts);
  if (!error.empty()) return;

  // A page of the picture's size in points, drawn in pixels
  const double points = 72 / page.dpi;
  const splatlas::Surface surface(cairo_pdf_surface_create_for_stream(
      splatlas::append, &bytes, points * page.size.width, points * page.size.height));
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_TITLE, page.title.c_str());
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATOR, "Splatlas");
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE, "");  // reproducible files
  const splatlas::Surface image = splatlas::image_of(page);
  {
    const splatlas::Context cairo(cairo_create(surface.get()));
    cairo_scale(cairo.get(), points, points);
    cairo_set_source_surface(cairo.get(), image.get(), 0, 0);
    cairo_pattern_set_filter(cairo_get_source(cairo.get()), CAIRO_FILTER_NEAREST);
    cairo_paint(cairo.get());
    splatlas::draw_layer(cairo.get(), *page.layer, fonts);
    if (cairo_status(cairo.get()) != CAIRO_STATUS_SUCCESS)
      error = cairo_status_to_string(cairo_status(cairo.get()));
  }
  cairo_surface_finish(surface.get());
  const cairo_status_t status = cairo_surface_status(surface.get());
  if (error.empty() && status != CAIRO_STATUS_SUCCESS) error = cairo_status_to_string(status);
}
