#include "player/page/annotate_picture.h"

#include <algorithm>
#include <map>

#include "format/result_macros.h"
#include "format/text/ascii_text.h"

namespace splatlas {
namespace {

constexpr double kTightRows = 0.2, kWideRows = 0.5;             // gaps between labels, in em
constexpr double kMaxLabelWidth = 0.26, kMinLabelWidth = 0.13;  // of the picture's width
constexpr double kFigureWidth = 0.63;                           // of it, beside columns of labels
constexpr double kLabelSpacing = 1.2;                           // distance of baselines, in em
constexpr double kLabelGapPoints = 12;                          // from structures to labels
constexpr double kMinFigure = 0.2;                              // of the picture's sides

/// True if all texts lie in the picture, and a figure remains.
bool fits(const PageLayout& layout) {
  const PictureSize& size = layout.scene.picture.size;
  const PageBox all{0, 0, static_cast<double>(size.width), static_cast<double>(size.height)};
  const double em = kLabelPoints * layout.pt;
  if (layout.figure.width() < 4 * em || layout.figure.height() < 4 * em) return false;
  return std::ranges::all_of(layout.layer.texts,
                             [&](const PlacedText& text) { return contains(all, text.box()); }) &&
         std::ranges::all_of(layout.layer.lines, [&](const PlacedLine& line) {
           return line.from.x >= 0 && line.to.x <= size.width;
         });
}

/// All items. `unlabelled` is the number that the note reports.
PageLayout lay_out(const AnnotatedScene& scene, const AnnotationOptions& options, const MeasureText& measure,
                   const FreeSpace& free_space, const std::vector<bool>& is_listed, std::size_t unlabelled) {
  PageLayout layout(scene, options, measure, free_space);
  layout.is_listed = is_listed;
  layout.place_blocks(unlabelled);
  if (options.items.orientation) layout.place_orientation();
  if (options.items.scale_bar) layout.place_scale_bar();
  if (options.items.labels) layout.place_structure_labels();
  return layout;
}

Result<AnnotationLayer> annotated_in(const FreeSpace& free_space, const AnnotatedScene& scene,
                                     const AnnotationOptions& options, const MeasureText& measure) {
  // Beside labels, the legend lists what has none; without a legend, a note tells their number. Both take
  // room from the labels, so that more may lack one.
  const bool completes = options.items.labels && options.items.legend;
  std::vector<bool> is_listed(scene.structures.size(), !completes);
  std::optional<PageLayout> layout(lay_out(scene, options, measure, free_space, is_listed, 0));
  constexpr int kMaxPasses = 4;
  std::size_t told = 0;
  for (int pass = 0; pass < kMaxPasses; ++pass) {
    const std::size_t unlabelled = completes ? 0 : layout->layer.unlabelled;
    const std::vector<bool> before = is_listed;
    for (std::size_t s = 0; s < is_listed.size(); ++s) is_listed[s] = is_listed[s] || layout->lacks_label[s];
    if (is_listed == before && unlabelled <= told) break;
    told = unlabelled;
    layout.emplace(lay_out(scene, options, measure, free_space, is_listed, told));
  }
  // A later pass may have labelled what an earlier one listed
  if (completes && layout->lacks_label != is_listed) {
    PageLayout shorter = lay_out(scene, options, measure, free_space, layout->lacks_label, told);
    if (shorter.lacks_label == shorter.is_listed) layout.emplace(std::move(shorter));
  }
  if (!fits(*layout)) {
    const PictureSize& size = scene.picture.size;
    return fail(ErrorCode::kUsage,
                "picture size {}x{}: too small for its annotations, with labels of {:.0f} pixels; "
                "take a larger --size, a smaller --dpi or fewer items",
                size.width, size.height, kLabelPoints * layout->pt);
  }
  return std::move(layout->layer);
}

constexpr int kMaxPicks = 40000;
/// Longer texts would take the whole page, and seconds to lay out. Names of built atlases are never longer.
constexpr std::size_t kMaxTextBytes = 4000, kMaxNameBytes = 800;

std::string printed_name(const Structure& structure) {
  std::string name = structure.name.empty() ? structure.id : structure.name;
  std::replace(name.begin(), name.end(), '_', ' ');
  return printable(shortened(name, kMaxNameBytes));
}

}  // namespace

std::vector<const NamedStructure*> PageLayout::labelled_structures(
    const std::optional<PageBox>& within) const {
  std::vector<const NamedStructure*> chosen;
  for (const NamedStructure& one : scene.structures) chosen.push_back(&one);
  std::ranges::stable_sort(chosen, std::greater(),
                           [](const NamedStructure* one) { return one->visible.pixels; });
  const double em = kLabelPoints * pt;
  std::erase_if(chosen, [&](const NamedStructure* one) {
    const PagePoint anchor = one->visible.anchor;
    return !one->labelled || one->visible.pixels < em * em ||
           (within && !contains(*within, {anchor.x, anchor.y, anchor.x, anchor.y}));
  });
  chosen.resize(std::min(chosen.size(), options.max_labels.value_or(kMaxLabels)));
  return chosen;
}

Label PageLayout::label_of(const NamedStructure& structure, double max_width) const {
  const auto width = [&](std::string_view words) { return width_of(words, kLabelPoints); };
  Label label{balanced_lines(structure.name, max_width, width), 0, 0, structure.visible.anchor,
              structure.visible.pixels};
  for (const std::string& words : label.lines) label.width = std::max(label.width, width(words));
  const double em = kLabelPoints * pt;
  label.height =
      (static_cast<double>(label.lines.size()) - 1) * kLabelSpacing * em + (kAscent + kDescent) * em;
  return label;
}

void PageLayout::place_structure_labels() {
  // Break long names
  const double em = kLabelPoints * pt, leading = kLabelSpacing * em;
  const PageBox content = free_space.content().value_or(figure);
  const double gap = kLabelGapPoints * pt,
               side = std::max(content.left - figure.left, figure.right - content.right) - gap;
  const double page_width = scene.picture.size.width;
  const double max_width = std::clamp(side, kMinLabelWidth * page_width, kMaxLabelWidth * page_width);
  std::vector<Label> labels;
  std::vector<std::size_t> structure_of_label;
  for (const NamedStructure* one : labelled_structures(figure)) {  // that no block of text covers
    Label label = label_of(*one, max_width);
    if (label.lines.empty()) continue;
    labels.push_back(std::move(label));
    structure_of_label.push_back(static_cast<std::size_t>(one - scene.structures.data()));
  }

  // Place them and add their texts and leaders,
  // with generous gaps between rows if these lose no label.
  const auto place = [&](double row_gap) {
    const LabelSpace space{figure,   gap, row_gap * em, 0.3 * em, (kDotPoints + 2 * kLeaderPoints) * pt,
                           obstacles};
    return place_labels(labels, space, free_space);
  };
  std::vector<PlacedLabel> placed = place(kTightRows);
  if (auto wider = place(kWideRows); wider.size() >= placed.size()) placed = std::move(wider);
  for (const PlacedLabel& one : placed) {
    const Label& label = labels[one.label];
    lacks_label[structure_of_label[one.label]] = false;
    double baseline = one.box.top + kAscent * em;
    for (const std::string& words : label.lines) {
      PlacedText text_line = text(words, one.box.left, baseline, kLabelPoints);
      if (one.is_left) text_line.x = one.box.right - text_line.width;
      layer.texts.push_back(std::move(text_line));
      baseline += leading;
    }
    layer.lines.push_back(line(one.port, label.anchor, kLeaderPoints));
    layer.lines.back().casing = kLeaderCasingPoints * pt;
    const Inks inks = inks_at(label.anchor.y);
    layer.dots.push_back({label.anchor, kDotPoints * pt, kDotCasingPoints * pt, inks.ink, inks.paper});
  }
  layer.labels = placed.size();
  const auto named =
      static_cast<std::size_t>(std::ranges::count(scene.structures, true, &NamedStructure::labelled));
  layer.unlabelled = options.max_labels ? 0 : named - placed.size();
}

void PageLayout::reserve_room() {
  const double letters = 1.3 * kCapHeight * kLettersPoints * pt;
  if (options.items.orientation) figure.top += letters, figure.bottom -= letters;
  // A draft misses tiny structures: leave a row of the legend for them
  if (options.items.legend) figure.bottom -= kLegendRow * kLegendPoints * pt;
  if (!options.items.labels) return;
  const std::vector<const NamedStructure*> chosen = labelled_structures();
  const double gap = kLabelGapPoints * pt, page_width = scene.picture.size.width;
  const double column =
      std::max(0.5 * (figure.width() - kFigureWidth * page_width) - gap, kMinLabelWidth * page_width);
  double width = 0;
  for (const NamedStructure* one : chosen) width = std::max(width, label_of(*one, column).width);
  if (width == 0) return;
  figure.left += width + gap, figure.right -= width + gap;
}

PictureRegion region_of_figure(const AnnotatedScene& scene, const AnnotationOptions& options,
                               const MeasureText& measure) {
  if (!options.items.any()) return {};
  const FreeSpace empty(scene.picture.size);
  PageLayout layout(scene, options, measure, empty);
  if (options.items.labels && options.items.legend) {
    for (const NamedStructure* one : layout.labelled_structures())
      layout.is_listed[static_cast<std::size_t>(one - scene.structures.data())] = false;
  }
  // Reserve the line that tells the number of structures without a label: there are nearly always some
  layout.place_blocks(options.items.labels && !options.items.legend && !options.max_labels ? 99 : 0);
  if (options.items.orientation) layout.place_orientation();
  layout.reserve_room();

  const auto share = [](double from, double to, double side) {
    from = std::clamp(from / side, 0.0, 1 - kMinFigure), to = std::clamp(to / side, kMinFigure, 1.0);
    if (to - from >= kMinFigure) return std::pair(from, to);
    const double middle = std::clamp(0.5 * (from + to), 0.5 * kMinFigure, 1 - 0.5 * kMinFigure);
    return std::pair(middle - 0.5 * kMinFigure, middle + 0.5 * kMinFigure);
  };
  const auto [left, right] = share(layout.figure.left, layout.figure.right, scene.picture.size.width);
  const auto [top, bottom] = share(layout.figure.top, layout.figure.bottom, scene.picture.size.height);
  return {std::max(0.0, left), std::max(0.0, top), std::min(right, 1.0), std::min(bottom, 1.0)};
}

Result<AnnotationLayer> annotate_picture(const AnnotatedScene& scene, const AnnotationOptions& options,
                                         const MeasureText& measure) {
  if (!options.items.any()) return AnnotationLayer{};
  auto layer = annotated_in(FreeSpace(scene.picture), scene, options, measure);
  // In a picture full of faint hulls, names stand on these
  if (layer && options.items.labels && layer->labels == 0)
    return annotated_in(FreeSpace(scene.picture, 0.25f), scene, options, measure);
  return layer;
}

std::string printed_line(std::string_view text) {
  return printable(shortened(text, kMaxTextBytes));
}

std::string printed_lines(std::string_view text) {
  std::string lines = printable_lines(shortened(text, kMaxTextBytes));
  std::replace(lines.begin(), lines.end(), '\t', ' ');
  return lines;
}

std::vector<NamedStructure> named_structures(const Picture& picture, const StructureAt& at,
                                             const StructureGraph& graph, const Selection& selection,
                                             const std::vector<StructureIndex>& bearers) {
  std::map<StructureIndex, VisibleStructure> visible;
  IdGrid grid = sample_structures(picture, at, kMaxPicks);
  for (StructureIndex& s : grid.ids)
    if (s < bearers.size() && bearers[s] != kNoStructure) s = bearers[s];
  for (const VisibleStructure& one : visible_structures(grid)) visible.emplace(one.structure, one);
  std::vector<NamedStructure> structures;
  for (const StructureIndex s : graph.preorder()) {
    const auto found = visible.find(s);
    if (found == visible.end()) continue;
    structures.push_back({printed_name(graph[s]), selection.structures[s].color, found->second,
                          bearers.empty() || bearers[s] != kNoStructure});
  }
  return structures;
}

}  // namespace splatlas
