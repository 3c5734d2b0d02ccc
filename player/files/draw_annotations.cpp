#include "player/files/draw_annotations.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "format/result_macros.h"

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

Rgb3 codes_of(Rgb color) {
  return {color.r / 255.0, color.g / 255.0, color.b / 255.0};
}

/// Canvas on a picture. Pixels are converted one by one.
class Canvas {
 public:
  Canvas(Picture& picture, std::optional<Rgb> background) : picture_(picture), background_(background) {}

  /// Mixes `share` of a colour into one pixel, if it is in the picture.
  void mix(int x, int y, Rgb color, double share) {
    const PictureSize& size = picture_.size;
    if (!(share > 0) || x < 0 || y < 0 || x >= size.width || y >= size.height) return;
    float* const pixel =
        &picture_.rgba[4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width) +
                            static_cast<std::size_t>(x))];
    const double under = (1 - share) * alpha_over_background(pixel), alpha = share + under;
    const Rgb3 over = codes_of(color);
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

  // Texts
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

}  // namespace splatlas
