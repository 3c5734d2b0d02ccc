#include "player/files/svg_document.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <string_view>

#include <fmt/format.h>
#include <utf8cpp/utf8.h>

#include "format/text/ascii_text.h"

namespace splatlas {
namespace {

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

}  // namespace splatlas
