#include "player/files/draw_annotations.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string_view>

#include <dlfcn.h>
#include <fmt/format.h>
#include <utf8cpp/utf8.h>

#include "format/result_macros.h"
#include "format/text/ascii_text.h"

namespace splatlas {
namespace {

using Rgb3 = std::array<double, 3>;

/// Overlap of the interval [from, to] with the unit interval around `at`.
double unit_overlap(double from, double to, double at) {
  return std::clamp(std::min(to, at + 0.5) - std::max(from, at - 0.5), 0.0, 1.0);
}

double to_code(double linear) {
  return encode_srgb(std::clamp(linear, 0.0, 1.0));
}

/// Canvas on a picture. Pixels are converted one by one.
class Canvas {
 public:
  Canvas(Picture& picture, std::optional<Rgb> background) : picture_(picture), background_(background) {}

  /// Mixes `share` of a colour into one pixel, if it is in the picture.
  void mix(int x, int y, Rgb color, double share) {
    const PictureSize& size = picture_.size;
    if (!(share > 0) || x < 0 || y < 0 || x >= size.width || y >= size.height) return;
    float* const pixel = &picture_.rgba[4 * size.pixel(x, y)];
    const double under = (1 - share) * alpha_over_background(pixel), alpha = share + under;
    const Rgb3 over{color.r / 255.0, color.g / 255.0, color.b / 255.0};
    for (std::size_t c = 0; c < 3; ++c) {
      const double below = straight_code(pixel, c);
      pixel[c] = static_cast<float>(alpha * decode_srgb((share * over[c] + under * below) / alpha));
    }
    pixel[3] = static_cast<float>(alpha);
  }

  /// Mixes a shape: coverage(x, y) is a pixel's share.
  template <typename Coverage>
  void fill(const PageBox& box, Rgb color, double opacity, const Coverage& coverage) {
    const auto clamped = [](double at, int side) {
      return static_cast<int>(std::clamp(at, 0.0, 1.0 * side));
    };
    const int right = clamped(std::ceil(box.right), picture_.size.width);
    const int bottom = clamped(std::ceil(box.bottom), picture_.size.height);
    for (int y = clamped(std::floor(box.top), picture_.size.height); y < bottom; ++y) {
      for (int x = clamped(std::floor(box.left), picture_.size.width); x < right; ++x) {
        mix(x, y, color, opacity * coverage(x, y));
      }
    }
  }

  void box(const PlacedBox& one) {
    fill(one.box, one.color, one.opacity, [&](int x, int y) {
      return unit_overlap(one.box.left, one.box.right, x + 0.5) *
             unit_overlap(one.box.top, one.box.bottom, y + 0.5);
    });
  }
  void stroke(const PlacedLine& line, double width, Rgb color, double opacity) {
    const PageBox bounds{std::min(line.from.x, line.to.x), std::min(line.from.y, line.to.y),
                         std::max(line.from.x, line.to.x), std::max(line.from.y, line.to.y)};
    fill(bounds.grown(0.5 * width + 1), color, opacity,
         [&](int x, int y) { return stroke_coverage(line, width, x, y); });
  }
  void disc(PagePoint center, double radius, Rgb color, double opacity) {
    const PageBox bounds{center.x, center.y, center.x, center.y};
    fill(bounds.grown(radius + 1), color, opacity, [&](int x, int y) {
      const double away = std::hypot(x + 0.5 - center.x, y + 0.5 - center.y);
      return std::clamp(radius + 0.5 - away, 0.0, 1.0);
    });
  }

 private:
  [[nodiscard]] double alpha_over_background(const float* pixel) const {
    return background_ ? 1.0 : std::clamp(static_cast<double>(pixel[3]), 0.0, 1.0);
  }
  [[nodiscard]] double straight_code(const float* pixel, std::size_t c) const {
    const double alpha = std::clamp(static_cast<double>(pixel[3]), 0.0, 1.0);
    if (!background_) return alpha > 0 ? to_code(static_cast<double>(pixel[c]) / alpha) : 0;
    const std::array<std::uint8_t, 3> channels{background_->r, background_->g, background_->b};
    return to_code(static_cast<double>(pixel[c]) +
                   (1 - alpha) * static_cast<double>(srgb_to_linear(channels[c])));
  }

  Picture& picture_;
  std::optional<Rgb> background_;
};

constexpr double kMmPerInch = 25.4;

std::string base64(std::span<const std::byte> bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t n = 0; n < bytes.size(); n += 3) {
    const std::size_t left = bytes.size() - n;
    const auto byte = [&](std::size_t i) {
      return i < left ? std::to_integer<std::uint32_t>(bytes[n + i]) : 0u;
    };
    const std::uint32_t group = byte(0) << 16 | byte(1) << 8 | byte(2);
    for (std::size_t digit = 0; digit < 4; ++digit) {
      text += digit <= left ? kDigits[group >> (18 - 6 * digit) & 63u] : '=';
    }
  }
  return text;
}

/// True if the first letter of a text is of a script from right to left.
bool is_right_to_left(std::string_view text) {
  const auto is_letter = [](std::uint32_t c) {
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= 0xaa && c != 0xd7 && c < 0x2000) ||
           c >= 0x2c00;
  };
  for (auto at = text.begin(); at != text.end();) {
    const std::uint32_t c = utf8::unchecked::next(at);
    if (!is_letter(c)) continue;
    return (c >= 0x590 && c <= 0x8ff) || (c >= 0xfb1d && c <= 0xfdff) || (c >= 0xfe70 && c <= 0xfeff) ||
           (c >= 0x10800 && c <= 0x10fff) || (c >= 0x1e800 && c <= 0x1efff);
  }
  return false;
}

/// XML text: control characters, which XML 1.0 forbids, are replaced.
std::string escaped(std::string text) {
  std::ranges::replace_if(
      text, [](unsigned char c) { return c < 0x20; }, ' ');
  return escaped_markup(text);
}

class Document {
 public:
  template <typename... Args>
  void add(fmt::format_string<Args...> format, Args&&... args) {
    fmt::format_to(std::back_inserter(text), format, std::forward<Args>(args)...);
  }

  void stroke(const PlacedLine& line, double width, Rgb color, double opacity) {
    add("<line x1=\"{:.2f}\" y1=\"{:.2f}\" x2=\"{:.2f}\" y2=\"{:.2f}\" stroke=\"{}\" stroke-width=\"{:.2f}\"",
        line.from.x, line.from.y, line.to.x, line.to.y, to_hex(color), width);
    add_opacity("stroke-opacity", opacity);
  }
  void disc(PagePoint center, double radius, Rgb color, double opacity) {
    add("<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"{:.2f}\" fill=\"{}\"", center.x, center.y, radius,
        to_hex(color));
    add_opacity("fill-opacity", opacity);
  }
  void box(const PlacedBox& one) {
    add("<rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\" fill=\"{}\"", one.box.left,
        one.box.top, one.box.width(), one.box.height(), to_hex(one.color));
    add_opacity("fill-opacity", one.opacity);
  }
  void add_text(const PlacedText& one) {
    if (one.text.empty()) return;
    const bool from_right = is_right_to_left(one.text);
    add("<text x=\"{:.2f}\" y=\"{:.2f}\" font-size=\"{:.2f}\" textLength=\"{:.2f}\" "
        "lengthAdjust=\"spacingAndGlyphs\" fill=\"{}\"",
        from_right ? one.x + one.width : one.x, one.y, one.size, one.width, to_hex(one.color));
    if (from_right) add(" direction=\"rtl\"");
    if (one.style == FontStyle::kBold) add(" font-weight=\"bold\"");
    if (one.style == FontStyle::kItalic) add(" font-style=\"italic\"");
    add(">{}</text>\n", escaped(one.text));
  }

  std::string text;

 private:
  void add_opacity(std::string_view name, double opacity) {
    if (opacity < 1) add(" {}=\"{}\"", name, opacity);
    add("/>\n");
  }
};

}  // namespace

double stroke_coverage(const PlacedLine& line, double width, int x, int y) {
  const double dx = line.to.x - line.from.x, dy = line.to.y - line.from.y, length = std::hypot(dx, dy);
  if (!(length > 0)) return 0;
  const double px = x + 0.5 - line.from.x, py = y + 0.5 - line.from.y;
  const double along = (px * dx + py * dy) / length, across = (px * dy - py * dx) / length;
  return unit_overlap(0, length, along) * unit_overlap(-0.5 * width, 0.5 * width, across);
}

Result<void> draw_annotations(Picture& picture, const AnnotationLayer& layer, std::optional<Rgb> background,
                              const TextDrawer* drawer) {
  std::vector<TextCoverage> texts;
  for (const PlacedText& text : layer.texts) {
    SPLATLAS_ASSIGN_OR_RETURN(TextCoverage drawn, (*drawer)->draw(text));
    texts.push_back(std::move(drawn));
  }

  Canvas canvas(picture, background);
  paint_shapes(layer, canvas);

  for (std::size_t n = 0; n < texts.size(); ++n) {
    const TextCoverage& text = texts[n];
    std::size_t at = 0;
    for (int y = 0; y < text.height; ++y) {
      for (int x = 0; x < text.width; ++x, ++at) {
        canvas.mix(text.left + x, text.top + y, layer.texts[n].color,
                   std::min(1.0, static_cast<double>(text.coverage[at])));
      }
    }
  }
  return {};
}

std::string svg_document(std::span<const std::byte> png, const PictureSize& size, double dpi,
                         const AnnotationLayer& layer) {
  Document svg;
  svg.add(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" "
      "width=\"{:.3f}mm\" height=\"{:.3f}mm\" viewBox=\"0 0 {} {}\" "
      "font-family=\"'Liberation Sans', Arial, Helvetica, 'DejaVu Sans', sans-serif\">\n",
      size.width * kMmPerInch / dpi, size.height * kMmPerInch / dpi, size.width, size.height);
  svg.add("<image width=\"{}\" height=\"{}\" xlink:href=\"data:image/png;base64,{}\"/>\n", size.width,
          size.height, base64(png));
  paint_shapes(layer, svg);
  for (const PlacedText& one : layer.texts) svg.add_text(one);
  svg.add("</svg>\n");
  return std::move(svg.text);
}

Result<void*> load_function(const char* module, const char* function, const char* library) {
  void* const handle = dlopen(module, RTLD_LAZY | RTLD_LOCAL);
  if (handle == nullptr) {
    const char* reason = dlerror();
    return fail(ErrorCode::kFailed, "cannot load {} ({}): {}", module, library,
                reason ? reason : "unknown reason");
  }
  void* const found = dlsym(handle, function);
  if (found != nullptr) return found;
  return fail(ErrorCode::kFailed, "{} has no {}: it is of another version", module, function);
}

TextDrawer::TextDrawer(const std::filesystem::path& font) {
  opening_ = std::async(std::launch::async, [file = font.string()]() -> OpenedTextEngine {
    SPLATLAS_ASSIGN_OR_RETURN(void* const function,
                              load_function(kTextModule, kOpenTextEngineName, "Pango and Cairo"));
    OpenedTextEngine engine;
    reinterpret_cast<OpenTextEngine>(function)(file, engine);
    return engine;
  });
}

Result<void> TextDrawer::wait() {
  if (opening_.valid()) opened_ = opening_.get();
  if (!opened_) return tl::unexpected(opened_.error());
  return {};
}

}  // namespace splatlas
