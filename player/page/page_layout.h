// Content and parts of a page: blocks of text at the bottom, and the figure above them.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "format/content/color.h"
#include "player/camera.h"
#include "player/page/annotation.h"
#include "player/page/place_labels.h"
#include "player/page/visible_structures.h"
#include "player/picture.h"

namespace splatlas {

/// Breaks UTF-8 text into lines of at most `max_width`, at blanks. A longer word is broken between
/// characters. A line has at least one character. `width_of` gives the width of a line.
[[nodiscard]] std::vector<std::string> wrap_text(std::string_view text, double max_width,
                                                 const std::function<double(std::string_view)>& width_of);

/// The same number of lines, but as equally long as possible.
[[nodiscard]] std::vector<std::string> balanced_lines(
    std::string_view text, double max_width, const std::function<double(std::string_view)>& width_of);

/// The longest beginning of the text that fits with an ellipsis; the whole text if it fits.
[[nodiscard]] std::string shortened_text(std::string_view text, double max_width,
                                         const std::function<double(std::string_view)>& width_of);

struct NamedStructure {
  std::string name;
  Rgb color;
  VisibleStructure visible;
  bool labelled = true;  ///< may get a label
};

struct AnnotatedScene {
  const Picture& picture;
  View view;
  std::optional<Rgb> background = std::nullopt;  ///< none: transparent, annotated as a white one
  std::vector<NamedStructure> structures = {};  ///< of labels and legend; entries of the legend in this order
  /// At the bottom of a vertical gradient from `background`; none: the same.
  std::optional<Rgb> background_bottom = std::nullopt;
};

/// The colour on the way from `a` to `b`, in codes of sRGB.
[[nodiscard]] Rgb mix(Rgb a, Rgb b, double share);

struct AnnotationOptions {
  AnnotationItems items = {};
  /// Labels of the largest structures. Not set: kMaxLabels, and a note counts the others.
  std::optional<std::size_t> max_labels = std::nullopt;
  std::string caption = {}, citation = {};
  /// Pixels per inch in print. Not set: the short side has 160 mm, but labels at least 11 pixels.
  std::optional<double> dpi = std::nullopt;
};

inline constexpr std::size_t kMaxLabels = 40;  ///< on a page

/// Sizes of texts in points, and of lines.
inline constexpr double kLabelPoints = 8.5, kLegendPoints = 8, kCaptionPoints = 9.5, kCitationPoints = 7,
                        kNotePoints = 7, kScalePoints = 8, kLettersPoints = 13;
inline constexpr double kLineSpacing = 1.3;  ///< distance of baselines, in em
inline constexpr double kLegendRow = 1.45;   ///< height of a row of the legend, in em
inline constexpr double kLeaderPoints = 0.5, kLeaderCasingPoints = 1.5, kDotPoints = 1.3,
                        kDotCasingPoints = 0.6;
inline constexpr double kRulePoints = 0.4, kScaleBarPoints = 1.2, kTickPoints = 5;

/// Pixels per inch: that of the options, or a default that depends on the size.
[[nodiscard]] double annotation_dpi(const AnnotationOptions& options, const PictureSize& size);

/// Length of a scale bar: the largest of 1, 2 and 5 times powers of ten up to `max_mm`; 0 unless that is > 0.
[[nodiscard]] double scale_bar_mm(double max_mm);

/// Layout of one page. The functions of the parts add to `layer`, and to `obstacles` for labels.
struct PageLayout {
  PageLayout(const AnnotatedScene& scene_, const AnnotationOptions& options_, const MeasureText& measure_,
             const FreeSpace& free_space_);

  const AnnotatedScene& scene;
  const AnnotationOptions& options;
  const MeasureText& measure;
  const FreeSpace& free_space;
  double pt;       ///< pixels per point
  PageBox page;    ///< the picture inside its margins
  PageBox figure;  ///< the part of the page above the blocks of text
  AnnotationLayer layer;
  std::vector<PageBox> obstacles;
  std::vector<bool> is_listed;    ///< [structure]: in the legend, if it has room
  std::vector<bool> lacks_label;  ///< [structure]: place_structure_labels() has placed none

  /// The background at a height of the page, and the colours of text on it.
  struct Inks {
    Rgb paper, ink, faint;
  };
  [[nodiscard]] Inks inks_at(double y) const;
  /// Text that starts at (x, baseline).
  [[nodiscard]] PlacedText text(std::string_view words, double x, double baseline, double points,
                                FontStyle style = FontStyle::kRegular) const;
  [[nodiscard]] PlacedLine line(PagePoint from, PagePoint to, double points) const;
  [[nodiscard]] double width_of(std::string_view words, double points,
                                FontStyle style = FontStyle::kRegular) const;
  /// Reports that an item covers structures, and puts a plate behind it.
  void cover(const PageBox& box, std::string_view item);

  /// Places caption, citation, legend and a note about `unlabelled` structures, upwards from the bottom.
  void place_blocks(std::size_t unlabelled);
  void place_orientation();
  void place_scale_bar();
  /// Places the labels of the largest structures.
  void place_structure_labels();
  /// Takes room for the letters above and below the figure, and for the columns of labels beside it.
  void reserve_room();
  /// Structures to label, at most those of the options, with anchors in a box: the largest ones first.
  [[nodiscard]] std::vector<const NamedStructure*> labelled_structures(
      const std::optional<PageBox>& within = std::nullopt) const;

 private:
  /// A label with lines of at most `max_width` pixels, unless a word is longer.
  [[nodiscard]] Label label_of(const NamedStructure& structure, double max_width) const;
  void place_paragraph(std::string_view words, double points, FontStyle style, Rgb Inks::*ink);
  void place_legend();
};

}  // namespace splatlas
