// Annotations of a picture: requested items, and placed texts, lines and boxes.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "format/content/color.h"

namespace splatlas {

struct AnnotationItems {
  bool labels = false;       ///< names with leader lines
  bool legend = false;       ///< colour swatches with names
  bool scale_bar = false;    ///< length in mm at the plane of the view's centre
  bool orientation = false;  ///< anatomical directions at the picture's edges
  bool caption = false;
  bool citation = false;

  [[nodiscard]] bool any() const {
    return labels || legend || scale_bar || orientation || caption || citation;
  }
  friend bool operator==(const AnnotationItems&, const AnnotationItems&) = default;
};

/// A point in picture coordinates: pixels from the top left corner.
struct PagePoint {
  double x = 0, y = 0;
};

/// An axis-aligned box in picture coordinates.
struct PageBox {
  double left = 0, top = 0, right = 0, bottom = 0;

  [[nodiscard]] double width() const { return right - left; }
  [[nodiscard]] double height() const { return bottom - top; }
  [[nodiscard]] PageBox grown(double by) const { return {left - by, top - by, right + by, bottom + by}; }
};

/// True if the interiors intersect.
[[nodiscard]] inline bool overlap(const PageBox& a, const PageBox& b) {
  return a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
}
[[nodiscard]] inline bool contains(const PageBox& outer, const PageBox& inner) {
  return inner.left >= outer.left && inner.right <= outer.right && inner.top >= outer.top &&
         inner.bottom <= outer.bottom;
}

enum class FontStyle : std::uint8_t { kRegular, kBold, kItalic };

/// Width in pixels of one line of UTF-8 text at a font size in pixels per em.
using MeasureText = std::function<double(std::string_view text, double size, FontStyle style)>;

/// Extents of a line above and below its baseline, in em. They include accents of capitals.
inline constexpr double kAscent = 0.93, kDescent = 0.24, kCapHeight = 0.72;

/// One line of text. `x` is its left end and `y` its baseline.
struct PlacedText {
  std::string text;
  double x = 0, y = 0, width = 0, size = 0;  ///< pixels; `size` per em
  FontStyle style = FontStyle::kRegular;
  Rgb color = {};

  [[nodiscard]] PageBox box() const { return {x, y - kAscent * size, x + width, y + kDescent * size}; }
};

/// A straight stroke with flat ends. A casing is a wider, translucent stroke below it.
struct PlacedLine {
  PagePoint from, to;
  double width = 0, casing = 0;  ///< pixels; `casing` is the width of the casing, 0 for none
  Rgb color, casing_color;
};

/// A filled disc, with a casing as that of lines.
struct PlacedDot {
  PagePoint center;
  double radius = 0, casing = 0;
  Rgb color, casing_color;
};

struct PlacedBox {
  PageBox box;
  Rgb color;
  double opacity = 1;
};

/// Opacity of casings and of the plates behind texts that cover structures.
inline constexpr double kCasingOpacity = 0.7, kPlateOpacity = 0.85;

/// Texts beside a picture on a page of A4. All but the heading may have several lines.
struct PageTexts {
  std::string heading, question, caption;
};

/// Everything to draw over a picture, in this order: boxes, lines, dots, texts.
struct AnnotationLayer {
  std::vector<PlacedBox> boxes;
  std::vector<PlacedLine> lines;
  std::vector<PlacedDot> dots;
  std::vector<PlacedText> texts;
  std::vector<std::string> notes;  ///< lines for the user, such as texts that cover structures
  std::size_t labels = 0, unlabelled = 0, legend_entries = 0;
};

/// Calls painter.box(PlacedBox), painter.stroke(PlacedLine, width, color, opacity) and
/// painter.disc(center, radius, color, opacity) for everything but the texts, in the order of drawing: all
/// casings come before all lines and dots, so that no casing cuts another line.
template <typename Painter>
void paint_shapes(const AnnotationLayer& layer, Painter& painter) {
  for (const PlacedBox& one : layer.boxes) painter.box(one);
  for (const PlacedLine& one : layer.lines) {
    if (one.casing > 0) painter.stroke(one, one.casing, one.casing_color, kCasingOpacity);
  }
  for (const PlacedDot& one : layer.dots) {
    painter.disc(one.center, one.radius + one.casing, one.casing_color, kCasingOpacity);
  }
  for (const PlacedLine& one : layer.lines) painter.stroke(one, one.width, one.color, 1);
  for (const PlacedDot& one : layer.dots) painter.disc(one.center, one.radius, one.color, 1);
}

}  // namespace splatlas
