#include "player/page/page_layout.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "format/tasks/task_control.h"
#include "format/text/ascii_text.h"

namespace splatlas {
namespace {

constexpr double kDefaultShortSideInch = 160 / 25.4;
constexpr double kMargin = 0.035;     // of the short side
constexpr double kMaxScaleBar = 0.2;  // of the width
constexpr double kMaxLegend = 0.3;    // of the height
constexpr double kMaxColumn = 0.4;    // of the width, for few long names
constexpr Rgb kBlack{26, 26, 26}, kWhite{242, 242, 242}, kDarkGrey{95, 95, 95}, kLightGrey{165, 165, 165};

float luminance(Rgb color) {
  return 0.2126f * srgb_to_linear(color.r) + 0.7152f * srgb_to_linear(color.g) +
         0.0722f * srgb_to_linear(color.b);
}

/// Contrast of two colours, from 1 to 21 (Web Content Accessibility Guidelines 2.1).
float contrast(Rgb a, Rgb b) {
  const auto [least, most] = std::minmax({luminance(a), luminance(b)});
  return (most + 0.05f) / (least + 0.05f);
}

/// The end of the UTF-8 character that holds the byte before `bytes`.
std::size_t whole_characters(std::string_view text, std::size_t bytes) {
  while (bytes < text.size() && (static_cast<unsigned char>(text[bytes]) & 0xc0u) == 0x80u) ++bytes;
  return std::min(bytes, text.size());
}

/// Bytes of the longest beginning of whole characters that `fits`. The cost follows the beginning, not the
/// text: exponential and binary search.
template <typename Fits>
std::size_t fitting(std::string_view text, const Fits& fits) {
  std::size_t most = 0, beyond = whole_characters(text, 1);  // fits; does not fit
  while (fits(beyond)) {
    most = beyond;
    if (most == text.size()) return most;
    beyond = whole_characters(text, 2 * most);
  }
  while (whole_characters(text, most + 1) < beyond) {
    std::size_t middle = whole_characters(text, (most + beyond) / 2);
    if (middle == beyond) middle = whole_characters(text, most + 1);
    (fits(middle) ? most : beyond) = middle;
  }
  return most;
}

}  // namespace

Rgb mix(Rgb a, Rgb b, double share) {
  const auto channel = [share](std::uint8_t from, std::uint8_t to) {
    return static_cast<std::uint8_t>(std::lround(from + share * (to - from)));
  };
  return {channel(a.r, b.r), channel(a.g, b.g), channel(a.b, b.b)};
}

double scale_bar_mm(double max_mm) {
  if (!(max_mm > 0) || !std::isfinite(max_mm)) return 0;
  const int exponent = static_cast<int>(std::floor(std::log10(max_mm)));
  constexpr double kRounding = 1 + 1e-12;  // a length of exactly one step is reached
  for (int e = exponent + 1; e >= exponent - 1; --e) {
    for (const double step : {5.0, 2.0, 1.0}) {
      const double length = e >= 0 ? step * std::pow(10, e) : step / std::pow(10, -e);
      if (length <= max_mm * kRounding) return length;
    }
  }
  return 0;
}

double annotation_dpi(const AnnotationOptions& options, const PictureSize& size) {
  if (options.dpi) return *options.dpi;
  constexpr double kMinTextPixels = 11;
  const double fitted = std::min(size.width, size.height) / kDefaultShortSideInch;
  return std::max(fitted, 72 * kMinTextPixels / kLabelPoints);
}

PageLayout::PageLayout(const AnnotatedScene& scene_, const AnnotationOptions& options_,
                       const MeasureText& measure_, const FreeSpace& free_space_)
    : scene(scene_),
      options(options_),
      measure(measure_),
      free_space(free_space_),
      pt(annotation_dpi(options_, scene_.picture.size) / 72),
      is_listed(scene_.structures.size(), true),
      lacks_label(scene_.structures.size(), true) {
  const double width = scene.picture.size.width, height = scene.picture.size.height;
  const double margin = kMargin * std::min(width, height);
  page = figure = {margin, margin, width - margin, height - margin};
}

PageLayout::Inks PageLayout::inks_at(double y) const {
  constexpr float kLegible = 3;  // contrast
  const Rgb top = scene.background.value_or(Rgb{255, 255, 255});
  const Rgb paper =
      mix(top, scene.background_bottom.value_or(top), std::clamp(y / scene.picture.size.height, 0.0, 1.0));
  const bool dark = luminance(paper) < 0.18f;
  const Rgb ink = dark ? kWhite : kBlack, faint = dark ? kLightGrey : kDarkGrey;
  return {paper, ink, contrast(faint, paper) < kLegible ? ink : faint};
}

double PageLayout::width_of(std::string_view words, double points, FontStyle style) const {
  return measure(words, points * pt, style);
}

PlacedText PageLayout::text(std::string_view words, double x, double baseline, double points,
                            FontStyle style) const {
  return {std::string(words),   x, baseline, width_of(words, points, style), points * pt, style,
          inks_at(baseline).ink};
}

PlacedLine PageLayout::line(PagePoint from, PagePoint to, double points) const {
  const Inks inks = inks_at(from.y);
  return {from, to, points * pt, 0, inks.ink, inks.paper};
}

void PageLayout::cover(const PageBox& box, std::string_view item) {
  if (free_space.is_free(box)) return;
  layer.boxes.push_back({box, inks_at(box.bottom).paper, kPlateOpacity});
  layer.notes.push_back(
      fmt::format("the {} covers structures; take a smaller --zoom, a larger --size or fewer items", item));
}

void PageLayout::place_paragraph(std::string_view words, double points, FontStyle style, Rgb Inks::*ink) {
  const auto width = [&](std::string_view part) { return width_of(part, points, style); };
  std::vector<std::string> lines;
  for (const std::string_view paragraph : split(words, '\n'))
    for (std::string& line : wrap_text(paragraph, page.width(), width)) lines.push_back(std::move(line));
  const double leading = kLineSpacing * points * pt;
  for (std::size_t n = lines.size(); n-- > 0; figure.bottom -= leading) {
    layer.texts.push_back(text(lines[n], page.left, figure.bottom - kDescent * points * pt, points, style));
    layer.texts.back().color = inks_at(figure.bottom).*ink;
  }
}

void PageLayout::place_legend() {
  std::vector<const NamedStructure*> listed;
  for (std::size_t s = 0; s < scene.structures.size(); ++s)
    if (is_listed[s]) listed.push_back(&scene.structures[s]);
  if (listed.empty()) return;
  const double em = kLegendPoints * pt, swatch = 1.5 * em, gap = 0.5 * em, row = kLegendRow * em;
  const auto width = [&](std::string_view name) { return width_of(name, kLegendPoints); };

  // Divide the page into columns as wide as the longest name, but for one of ten
  std::vector<double> widths;
  for (const NamedStructure* one : listed) widths.push_back(width(one->name));
  std::ranges::sort(widths);
  const double longest =
      std::min(widths.back(), std::max(widths[(widths.size() - 1) * 9 / 10], kMaxColumn * page.width()));
  const double cell = std::min(swatch + gap + 1.001 * longest + 2 * em, page.width() + 2 * em);
  const auto columns = std::max<std::size_t>(1, static_cast<std::size_t>((page.width() + 2 * em) / cell));
  const auto max_rows = static_cast<std::size_t>(std::max(1.0, kMaxLegend * scene.picture.size.height / row));
  const std::size_t all = listed.size();
  const std::size_t shown = all <= columns * max_rows ? all : columns * max_rows - 1;
  const std::size_t cells = shown + (shown < all ? 1 : 0);
  const std::size_t rows = (cells + columns - 1) / columns;

  // Fill them from top to bottom with what shows most
  std::ranges::stable_sort(listed, std::greater(),
                           [](const NamedStructure* one) { return one->visible.pixels; });
  const double pitch = (page.width() + 2 * em) / static_cast<double>(columns);
  const double top = figure.bottom - static_cast<double>(rows) * row;
  for (std::size_t n = 0; n < cells; ++n) {
    const std::size_t column = n / rows;
    const double x = page.left + static_cast<double>(column) * pitch;
    const double y = top + static_cast<double>(n % rows) * row,
                 baseline = y + 0.5 * row + 0.5 * kCapHeight * em;
    if (n == shown) {
      layer.texts.push_back(
          text(fmt::format("and {} more", all - shown), x, baseline, kLegendPoints, FontStyle::kItalic));
      continue;
    }
    const NamedStructure& one = *listed[n];
    const double room = std::min(x + cell - 2 * em, page.right) - x - swatch - gap;
    const PageBox box{x, y + 0.5 * row - 0.4 * em, x + swatch, y + 0.5 * row + 0.4 * em};
    layer.boxes.push_back({box, inks_at(box.bottom).faint});  // an outline, for the colour of the paper
    layer.boxes.push_back({box.grown(-kRulePoints * pt), one.color});
    layer.texts.push_back(
        text(shortened_text(one.name, room, width), x + swatch + gap, baseline, kLegendPoints));
  }
  layer.legend_entries = shown;
  figure.bottom = top;
}

void PageLayout::place_blocks(std::size_t unlabelled) {
  const double gap = 5 * pt;
  const auto block = [&](std::string_view item, const auto& place) {
    const double bottom = figure.bottom;
    const std::size_t boxes = layer.boxes.size(), texts = layer.texts.size();
    place();
    if (figure.bottom == bottom) return;
    const PageBox box{page.left, figure.bottom, page.right, bottom};
    if (!free_space.is_free(box)) {  // the plate lies below the swatches
      cover(box, item);
      std::rotate(layer.boxes.begin() + static_cast<std::ptrdiff_t>(boxes), layer.boxes.end() - 1,
                  layer.boxes.end());
      for (std::size_t n = texts; n < layer.texts.size(); ++n) layer.texts[n].color = inks_at(box.bottom).ink;
    }
    figure.bottom -= gap;
  };
  if (options.items.citation && !options.citation.empty()) {
    block("citation",
          [&] { place_paragraph(options.citation, kCitationPoints, FontStyle::kRegular, &Inks::faint); });
  }
  if (unlabelled > 0) {
    const std::string words = unlabelled == 1
                                  ? "1 more structure is not labelled."
                                  : fmt::format("{} more structures are not labelled.", unlabelled);
    block("note", [&] { place_paragraph(words, kNotePoints, FontStyle::kItalic, &Inks::faint); });
  }
  if (options.items.caption && !options.caption.empty()) {
    block("caption", [&] { place_paragraph(options.caption, kCaptionPoints, FontStyle::kBold, &Inks::ink); });
  }
  if (options.items.legend) block("legend", [&] { place_legend(); });
  if (figure.bottom == page.bottom) return;

  // Rule between the figure and the blocks
  const PageBox rule{page.left, figure.bottom - kRulePoints * pt, page.right, figure.bottom};
  if (free_space.is_free(rule)) {
    layer.lines.push_back(line({rule.left, figure.bottom}, {rule.right, figure.bottom}, kRulePoints));
    layer.lines.back().color = inks_at(figure.bottom).faint;
  }
  figure.bottom -= gap;
}

void PageLayout::place_orientation() {
  const ParallelView& plane = scene.view.plane;
  const auto opposite = [](Vec3 v) { return Vec3{-v[0], -v[1], -v[2]}; };
  const std::array<std::string, 4> letters{
      direction_letters(opposite(plane.right_lps)), direction_letters(plane.right_lps),
      direction_letters(plane.up_lps), direction_letters(opposite(plane.up_lps))};
  const double em = kLettersPoints * pt, middle_x = 0.5 * (page.left + page.right),
               middle_y = 0.5 * (figure.top + figure.bottom);
  std::array<PlacedText, 4> texts;
  double side = 0;
  for (std::size_t n = 0; n < 4; ++n) {
    texts[n] = text(letters[n], 0, 0, kLettersPoints, FontStyle::kBold);
    if (n < 2) side = std::max(side, texts[n].width);
  }
  texts[0].x = page.left, texts[1].x = page.right - texts[1].width;
  texts[0].y = texts[1].y = middle_y + 0.5 * kCapHeight * em;
  texts[2].x = middle_x - 0.5 * texts[2].width, texts[3].x = middle_x - 0.5 * texts[3].width;
  texts[2].y = figure.top + kCapHeight * em, texts[3].y = figure.bottom - 0.1 * em;
  bool covers = false;
  for (PlacedText& one : texts) {
    const PageBox box{one.x, one.y - kCapHeight * em, one.x + one.width, one.y};
    const PageBox plate = box.grown(2 * pt);
    if (!free_space.is_free(box))
      layer.boxes.push_back({plate, inks_at(plate.bottom).paper, kPlateOpacity}), covers = true;
    obstacles.push_back(one.box().grown(pt));
    one.color = inks_at(one.y).ink;
    layer.texts.push_back(std::move(one));
  }
  if (covers) {
    layer.notes.emplace_back(
        "letters of the orientation cover structures; take a smaller --zoom or a larger --size");
  }
  // Labels stand above and below the letters
  if (!options.items.labels) figure.left += side + 0.5 * em, figure.right -= side + 0.5 * em;
}

void PageLayout::place_scale_bar() {
  const double mm_per_pixel = scene.view.plane.mm_per_pixel;
  const double mm = scale_bar_mm(kMaxScaleBar * scene.picture.size.width * mm_per_pixel);
  if (mm <= 0) return;
  const double length = mm / mm_per_pixel, em = kScalePoints * pt, tick = kTickPoints * pt;
  PlacedText words =
      text(fmt::format("{} mm", mm) + (scene.view.eye_mm ? " at the centre" : ""), 0, 0, kScalePoints);
  const double width = std::max(length, words.width), height = tick + 1.35 * em;

  // Take the first free corner
  std::array<PageBox, 4> corners;
  for (std::size_t n = 0; n < 4; ++n) {
    const double left = n % 2 == 0 ? page.right - width : page.left;
    const double top = n < 2 ? figure.bottom - height : figure.top;
    corners[n] = {left, top, left + width, top + height};
  }
  const auto free = std::ranges::find_if(corners, [&](const PageBox& corner) {
    return free_space.is_free(corner) &&
           std::ranges::none_of(obstacles, [&](const PageBox& other) { return overlap(corner, other); });
  });
  const PageBox box = free == corners.end() ? corners.front() : *free;
  cover(box, "scale bar");

  // A bar with ticks, centred above its length
  const double middle = 0.5 * (box.left + box.right), left = middle - 0.5 * length,
               right = middle + 0.5 * length;
  const double y = box.top + 0.5 * tick, half = 0.5 * kScaleBarPoints * pt;
  layer.lines.push_back(line({left, y}, {right, y}, kScaleBarPoints));
  layer.lines.push_back(line({left + half, box.top}, {left + half, box.top + tick}, kScaleBarPoints));
  layer.lines.push_back(line({right - half, box.top}, {right - half, box.top + tick}, kScaleBarPoints));
  words.x = middle - 0.5 * words.width, words.y = box.top + tick + 1.05 * em;
  words.color = inks_at(words.y).ink;
  layer.texts.push_back(std::move(words));
  obstacles.push_back(box.grown(4 * pt));
}

std::vector<std::string> wrap_text(std::string_view text, double max_width,
                                   const std::function<double(std::string_view)>& width_of) {
  std::vector<std::string> lines;
  std::string line;
  while (!text.empty()) {
    check_task();
    const std::size_t blank = text.find(' ');
    std::string_view word = text.substr(0, blank);
    text = blank == std::string_view::npos ? std::string_view() : text.substr(blank + 1);
    if (word.empty()) continue;
    const std::string longer = line.empty() ? std::string(word) : line + " " + std::string(word);
    if (width_of(longer) <= max_width) {
      line = longer;
      continue;
    }
    if (!line.empty()) lines.push_back(line);
    while (true) {
      const auto fits = [&](std::size_t bytes) { return width_of(word.substr(0, bytes)) <= max_width; };
      const std::size_t end = std::max(whole_characters(word, 1), fitting(word, fits));
      if (end == word.size()) break;
      lines.emplace_back(word.substr(0, end));
      word.remove_prefix(end);
    }
    line = word;
  }
  if (!line.empty()) lines.push_back(line);
  return lines;
}

std::vector<std::string> balanced_lines(std::string_view text, double max_width,
                                        const std::function<double(std::string_view)>& width_of) {
  // The longest word is the narrowest line, unless it has to be broken
  double narrow = 0;
  for (const std::string_view word : split(text, ' ')) narrow = std::max(narrow, width_of(word));
  narrow = std::min(narrow, max_width);
  double wide = max_width;
  std::vector<std::string> lines = wrap_text(text, wide, width_of);
  constexpr int kSteps = 12;
  for (int step = 0; step < kSteps && lines.size() > 1; ++step) {
    const double middle = 0.5 * (narrow + wide);
    auto narrower = wrap_text(text, middle, width_of);
    const bool same = narrower.size() == lines.size();
    if (same) lines = std::move(narrower);
    (same ? wide : narrow) = middle;
  }
  return lines;
}

std::string shortened_text(std::string_view text, double max_width,
                           const std::function<double(std::string_view)>& width_of) {
  if (width_of(text) <= max_width) return std::string(text);
  constexpr const char* kEllipsis = "\xe2\x80\xa6";
  std::size_t end = fitting(text, [&](std::size_t bytes) {
    return width_of(std::string(text.substr(0, bytes)) + kEllipsis) <= max_width;
  });
  while (end > 0 && text[end - 1] == ' ') --end;
  return std::string(text.substr(0, end)) + kEllipsis;
}

}  // namespace splatlas
