#include "player/files/text_module.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>

#include <cairo-pdf.h>
#include <cairo.h>
#include <fontconfig/fontconfig.h>
#include <pango/pangocairo.h>
#include <pango/pangofc-fontmap.h>

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
using Canvas = std::unique_ptr<cairo_t, Destroy<cairo_destroy>>;
using FontConfig = std::unique_ptr<FcConfig, Destroy<FcConfigDestroy>>;
using FontPattern = std::unique_ptr<FcPattern, Destroy<FcPatternDestroy>>;
using FontMap = std::unique_ptr<PangoFontMap, Destroy<g_object_unref>>;
using TextContext = std::unique_ptr<PangoContext, Destroy<g_object_unref>>;
using Layout = std::unique_ptr<PangoLayout, Destroy<g_object_unref>>;
using Description = std::unique_ptr<PangoFontDescription, Destroy<pango_font_description_free>>;

constexpr double kA4Width = 595.28, kA4Height = 841.89;  // points
constexpr const char* kFamilies = "Liberation Sans,DejaVu Sans,sans-serif";

/// Adds the first face of a font file to a configuration. Returns its letters; none if it cannot be read.
std::vector<std::string> add_font(const std::string& file, FcConfig* config) {
  constexpr std::size_t kLetters = 20;
  const auto* const name = reinterpret_cast<const FcChar8*>(file.c_str());
  int faces = 0;
  const FontPattern font(FcFreeTypeQuery(name, 0, nullptr, &faces));
  FcCharSet* characters = nullptr;
  if (!font || FcPatternGetCharSet(font.get(), FC_CHARSET, 0, &characters) != FcResultMatch) return {};
  std::vector<std::string> letters;
  FcChar32 next = 0;
  std::array<FcChar32, FC_CHARSET_MAP_SIZE> map{};
  for (FcChar32 page = FcCharSetFirstPage(characters, map.data(), &next);
       page != FC_CHARSET_DONE && letters.size() < kLetters;
       page = FcCharSetNextPage(characters, map.data(), &next)) {
    for (FcChar32 bit = 0; bit < 32 * map.size() && letters.size() < kLetters; ++bit) {
      const gunichar c = page + bit;
      if ((map[bit / 32] >> bit % 32 & 1u) == 0 || g_unichar_isalpha(c) == FALSE) continue;
      std::array<char, 7> utf8{};
      g_unichar_to_utf8(c, utf8.data());
      letters.emplace_back(utf8.data());
    }
  }
  if (FcConfigAppFontAddFile(config, name) == FcFalse) return {};
  return letters;
}

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

cairo_status_t append(void* to, const unsigned char* data, unsigned length) {
  auto* const bytes = static_cast<std::vector<std::byte>*>(to);
  const auto* const first = reinterpret_cast<const std::byte*>(data);
  bytes->insert(bytes->end(), first, first + length);
  return CAIRO_STATUS_SUCCESS;
}

class PangoEngine : public TextEngine {
 public:
  /// `error`: set if there is no font, or if the file of `font` is none.
  PangoEngine(const std::string& font, std::string& error)
      : font_(font), config_(FcInitLoadConfigAndFonts()) {
    // Messages of the libraries would be lines of the program
    g_log_set_default_handler([](const char*, GLogLevelFlags, const char*, void*) {}, nullptr);
    std::vector<std::string> letters;
    if (!font.empty()) {
      letters = add_font(font, config_.get());
      if (letters.empty()) error = font + ": cannot be read as a font with letters; give a .ttf or .otf file";
    }
    map_.reset(pango_cairo_font_map_new_for_font_type(CAIRO_FONT_TYPE_FT));
    pango_fc_font_map_set_config(PANGO_FC_FONT_MAP(map_.get()), config_.get());
    if (!font.empty()) {
      // By its file: an installed font may have the same name
      const auto prefer = [](FcPattern* wanted, void* file) {
        FcPatternAddString(wanted, FC_FILE,
                           reinterpret_cast<const FcChar8*>(static_cast<std::string*>(file)->c_str()));
      };
      pango_fc_font_map_set_default_substitute(PANGO_FC_FONT_MAP(map_.get()), prefer, &font_, nullptr);
    }
    context_.reset(pango_font_map_create_context(map_.get()));
    pango_context_set_language(context_.get(), pango_language_from_string("en"));
    pango_context_set_round_glyph_positions(context_.get(), FALSE);
    cairo_font_options_t* const options = cairo_font_options_create();
    cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
    cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
    pango_cairo_context_set_font_options(context_.get(), options);
    cairo_font_options_destroy(options);
    const FcFontSet* const installed = FcConfigGetFonts(config_.get(), FcSetSystem);
    if (error.empty() && font.empty() && (installed == nullptr || installed->nfont == 0))
      error = "no font is installed; install fonts-liberation or fonts-dejavu-core, or take --font FILE";
    for (const std::string& letter : letters) {
      if (error.empty() && !draws(letter)) error = font + ": is damaged; its letters cannot be drawn";
    }
  }

  double width(std::string_view text, double size, FontStyle style) override {
    int units = 0;
    pango_layout_get_size(line_of(text, size, style).get(), &units, nullptr);
    return static_cast<double>(units) / PANGO_SCALE;
  }

  bool lacks_glyphs(std::string_view text) override {
    const Layout layout = line_of(text, 10, FontStyle::kRegular);
    pango_layout_set_single_paragraph_mode(layout.get(), FALSE);  // it has a glyph for ends of lines
    return pango_layout_get_unknown_glyphs_count(layout.get()) > 0;
  }

  /// Draws outlines: Cairo would move the glyphs of pictures to whole pixels.
  Result<TextCoverage> draw(const PlacedText& text) override {
    const Layout layout = line_of(text.text, text.size, text.style);
    const Box ink = ink_of(*layout);
    TextCoverage drawn;
    if (const std::string fault = fault_of_size(text.text, ink, text.size); !fault.empty())
      return fail(ErrorCode::kFailed, fault);
    if (ink.width <= 0 || ink.height <= 0) return drawn;
    drawn.left = static_cast<int>(std::floor(text.x + ink.left)) - 1;
    drawn.top = static_cast<int>(std::floor(text.y + ink.top)) - 1;
    drawn.width = static_cast<int>(std::ceil(text.x + ink.left + ink.width)) + 1 - drawn.left;
    drawn.height = static_cast<int>(std::ceil(text.y + ink.top + ink.height)) + 1 - drawn.top;
    const Surface surface(cairo_image_surface_create(CAIRO_FORMAT_A8, drawn.width, drawn.height));
    const Canvas cairo(cairo_create(surface.get()));
    cairo_set_antialias(cairo.get(), CAIRO_ANTIALIAS_BEST);
    cairo_move_to(cairo.get(), text.x - drawn.left, text.y - drawn.top);
    pango_cairo_layout_line_path(cairo.get(), pango_layout_get_line_readonly(layout.get(), 0));
    cairo_fill(cairo.get());
    if (cairo_status(cairo.get()) != CAIRO_STATUS_SUCCESS)
      return fail(ErrorCode::kFailed, cairo_status_to_string(cairo_status(cairo.get())));
    cairo_surface_flush(surface.get());
    const unsigned char* row = cairo_image_surface_get_data(surface.get());
    for (int y = 0; y < drawn.height; ++y, row += cairo_image_surface_get_stride(surface.get())) {
      for (int x = 0; x < drawn.width; ++x) drawn.coverage.push_back(static_cast<float>(row[x]) / 255);
    }
    return drawn;
  }

  Result<std::vector<std::byte>> encode_pdf(const PdfPage& page) override {
    // A page of the picture's size in points, or of A4
    const double points = 72 / page.dpi;
    const bool has_texts = !page.texts.heading.empty();
    const double width = has_texts ? kA4Width : points * page.size.width;
    const double height = has_texts ? kA4Height : points * page.size.height;
    if (!document_) {
      document_.reset(cairo_pdf_surface_create_for_stream(append, &bytes_, width, height));
      cairo_pdf_surface_set_metadata(document_.get(), CAIRO_PDF_METADATA_TITLE, page.title.c_str());
      cairo_pdf_surface_set_metadata(document_.get(), CAIRO_PDF_METADATA_CREATOR, "Splatlas");
      cairo_pdf_surface_set_metadata(document_.get(), CAIRO_PDF_METADATA_CREATE_DATE, "");  // reproducible
    }
    const Surface image = image_of(page);
    std::string fault;
    {
      const Canvas cairo(cairo_create(document_.get()));
      const double scale = has_texts ? draw_beside_picture(page, cairo.get()) : points;
      cairo_scale(cairo.get(), scale, scale);  // to pixels
      cairo_set_source_surface(cairo.get(), image.get(), 0, 0);
      cairo_pattern_set_filter(cairo_get_source(cairo.get()), CAIRO_FILTER_NEAREST);
      cairo_paint(cairo.get());
      fault = draw_layer(*page.layer, cairo.get());
      cairo_show_page(cairo.get());
      if (fault.empty() && cairo_status(cairo.get()) != CAIRO_STATUS_SUCCESS)
        fault = cairo_status_to_string(cairo_status(cairo.get()));
    }
    std::vector<std::byte> document;
    if (page.is_last) {
      cairo_surface_finish(document_.get());
      const cairo_status_t status = cairo_surface_status(document_.get());
      if (fault.empty() && status != CAIRO_STATUS_SUCCESS) fault = cairo_status_to_string(status);
      document_.reset();
      document = std::exchange(bytes_, {});
    }
    if (!fault.empty()) return fail(ErrorCode::kFailed, fault);
    return document;
  }

 private:
  /// In pixels, from the origin on the baseline.
  struct Box {
    double left = 0, top = 0, width = 0, height = 0;
  };

  [[nodiscard]] Layout line_of(std::string_view text, double size, FontStyle style) const {
    const Description font(pango_font_description_new());
    pango_font_description_set_family(font.get(), kFamilies);
    pango_font_description_set_absolute_size(font.get(), size * PANGO_SCALE);
    if (style == FontStyle::kBold) pango_font_description_set_weight(font.get(), PANGO_WEIGHT_BOLD);
    if (style == FontStyle::kItalic) pango_font_description_set_style(font.get(), PANGO_STYLE_ITALIC);
    Layout layout(pango_layout_new(context_.get()));
    pango_layout_set_font_description(layout.get(), font.get());
    pango_layout_set_single_paragraph_mode(layout.get(), TRUE);
    pango_layout_set_text(layout.get(), text.data(), static_cast<int>(text.size()));
    return layout;
  }

  /// Draws the texts of a page of A4 and moves the origin to its picture, whose points per pixel it returns.
  [[nodiscard]] double draw_beside_picture(const PdfPage& page, cairo_t* cairo) const {
    constexpr double kMargin = 48, kGap = 10, kWidth = kA4Width - 2 * kMargin;
    const auto paragraph = [&](const std::string& text, double size, FontStyle style, double max_height) {
      Layout layout = line_of(text, size, style);
      pango_layout_set_single_paragraph_mode(layout.get(), FALSE);
      pango_layout_set_width(layout.get(), static_cast<int>(kWidth * PANGO_SCALE));
      pango_layout_set_height(layout.get(), static_cast<int>(max_height * PANGO_SCALE));
      pango_layout_set_wrap(layout.get(), PANGO_WRAP_WORD_CHAR);
      pango_layout_set_ellipsize(layout.get(), PANGO_ELLIPSIZE_END);
      int height = 0;
      if (!text.empty()) pango_layout_get_size(layout.get(), nullptr, &height);
      return std::pair(std::move(layout), text.empty() ? 0 : height / double{PANGO_SCALE} + kGap);
    };
    const auto [heading, top] = paragraph(page.texts.heading, 16, FontStyle::kBold, 60);
    const auto [question, middle] = paragraph(page.texts.question, 12, FontStyle::kItalic, 100);
    const auto [caption, bottom] = paragraph(page.texts.caption, 11, FontStyle::kRegular, 250);
    const double room = kA4Height - 2 * kMargin - top - middle - bottom;
    const double scale = std::min(kWidth / page.size.width, room / page.size.height);
    const auto show = [&](const Layout& layout, double y) {
      cairo_move_to(cairo, kMargin, kMargin + y);
      pango_cairo_show_layout(cairo, layout.get());
    };
    const double below = top + scale * page.size.height + kGap;
    show(heading, 0), show(question, below), show(caption, below + middle);
    cairo_translate(cairo, (kA4Width - scale * page.size.width) / 2, kMargin + top);
    return scale;
  }

  /// True if the file of the font has ink and width for a letter, of a sensible size.
  [[nodiscard]] bool draws(const std::string& letter) const {
    constexpr double kSize = 1000;
    const Layout layout = line_of(letter, kSize, FontStyle::kRegular);
    const PangoLayoutLine* const line = pango_layout_get_line_readonly(layout.get(), 0);
    if (line->runs == nullptr) return false;
    const auto* const run = static_cast<const PangoGlyphItem*>(line->runs->data);
    FcPattern* const used = pango_fc_font_get_pattern(PANGO_FC_FONT(run->item->analysis.font));
    FcChar8* file = nullptr;
    if (FcPatternGetString(used, FC_FILE, 0, &file) != FcResultMatch ||
        font_ != reinterpret_cast<const char*>(file))
      return false;
    const Box ink = ink_of(*layout);
    int units = 0;
    pango_layout_get_size(layout.get(), &units, nullptr);
    return fault_of_size(letter, ink, kSize).empty() && ink.width > 0 && ink.height > 0 && units > 0 &&
           units < 8 * kSize * PANGO_SCALE;
  }

  [[nodiscard]] static Box ink_of(PangoLayout& layout) {
    PangoRectangle ink;
    pango_layout_line_get_extents(pango_layout_get_line_readonly(&layout, 0), &ink, nullptr);
    const auto pixels = [](int units) { return static_cast<double>(units) / PANGO_SCALE; };
    return {pixels(ink.x), pixels(ink.y), pixels(ink.width), pixels(ink.height)};
  }

  /// A damaged font may have glyphs of any size. Empty for sensible ones.
  static std::string fault_of_size(const std::string& text, const Box& ink, double size) {
    constexpr double kMaxEm = 8;
    const double em = kMaxEm * size;
    if (ink.height <= em && ink.width <= em * static_cast<double>(text.size() + 1)) return {};
    return "the glyphs of \"" + text + "\" are larger than 8 em; take another font";
  }

  /// Returns the first fault; empty if there is none.
  [[nodiscard]] std::string draw_layer(const AnnotationLayer& layer, cairo_t* cairo) const {
    const Painter painter{cairo};
    paint_shapes(layer, painter);
    for (const PlacedText& one : layer.texts) {
      const Layout layout = line_of(one.text, one.size, one.style);
      if (std::string fault = fault_of_size(one.text, ink_of(*layout), one.size); !fault.empty())
        return fault;
      set_color(cairo, one.color);
      cairo_move_to(cairo, one.x, one.y);
      pango_cairo_show_layout_line(cairo, pango_layout_get_line_readonly(layout.get(), 0));
    }
    return {};
  }

  std::string font_;  // file to prefer; empty: none
  FontConfig config_;
  FontMap map_;
  TextContext context_;
  std::vector<std::byte> bytes_;  // of the document, which writes to them until its end
  Surface document_;
};

}  // namespace
}  // namespace splatlas

extern "C" __attribute__((visibility("default"))) void splatlas_open_text_engine(
    const std::string& font, splatlas::OpenedTextEngine& engine) {
  std::string error;
  engine = std::make_unique<splatlas::PangoEngine>(font, error);
  if (!error.empty()) engine = splatlas::fail(splatlas::ErrorCode::kFailed, error);
}
