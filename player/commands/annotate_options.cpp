#include "player/commands/annotate_options.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "format/program/command_options.h"
#include "format/result_macros.h"

namespace splatlas {
namespace {

using Item = std::pair<std::string_view, bool AnnotationItems::*>;
constexpr std::array kItems{
    Item{"labels", &AnnotationItems::labels},      Item{"legend", &AnnotationItems::legend},
    Item{"scalebar", &AnnotationItems::scale_bar}, Item{"orientation", &AnnotationItems::orientation},
    Item{"caption", &AnnotationItems::caption},    Item{"citation", &AnnotationItems::citation}};
constexpr std::string_view kAll = "all";

constexpr int kMaxPicks = 40000;

std::string item_names() {
  std::string names;
  for (const auto& [name, member] : kItems) names += std::string(name) + ", ";
  return names + "or " + std::string(kAll);
}

template <typename Number>
std::optional<Number> number_within(std::string_view text, Number min, Number max) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number >= min && number <= max ? std::optional(number) : std::nullopt;
}

/// The name of a structure as printed: blanks for underscores.
std::string printed_name(const Structure& structure) {
  std::string name = structure.name.empty() ? structure.id : structure.name;
  std::ranges::replace(name, '_', ' ');
  return printable(name);
}

/// The structures in the renderer's picture, in the order of the tree.
std::vector<NamedStructure> structures_of(const Renderer& renderer, const Selection& selection,
                                          const Picture& picture) {
  const auto pick = [&](double x, double y) {
    const std::optional<Pick> found = renderer.pick(x, y);
    return found ? found->structure : kNoStructure;
  };
  std::map<StructureIndex, VisibleStructure> visible;
  for (const VisibleStructure& one : visible_structures(sample_structures(picture, pick, kMaxPicks))) {
    visible.emplace(one.structure, one);
  }
  const StructureGraph& graph = renderer.atlas().graph();
  std::vector<NamedStructure> structures;
  for (const StructureIndex s : graph.preorder()) {
    const auto found = visible.find(s);
    if (found == visible.end()) continue;
    structures.push_back({printed_name(graph[s]), selection.structures[s].color, found->second});
  }
  return structures;
}

AnnotationOptions options_of(const AnnotateRequest& request, const Provenance& provenance) {
  return {request.items, request.max_labels, request.caption.value_or(printable(provenance.title)),
          printable(provenance.citation), request.dpi};
}

MeasureText measure_with(const TextDrawer& drawer) {
  return [&drawer](std::string_view text, double size, FontStyle style) {
    return drawer.width(text, size, style);
  };
}

/// Structures of a small draft, with areas as in the picture.
Result<std::vector<NamedStructure>> structures_of_draft(Renderer& renderer, const Selection& selection,
                                                        const Camera& camera, const RenderOptions& options) {
  constexpr int kLongSide = 320;
  const double scale =
      std::min(1.0, static_cast<double>(kLongSide) / std::max(options.size.width, options.size.height));
  const auto side = [&](int pixels) { return std::max(1, static_cast<int>(pixels * scale)); };
  RenderOptions draft = options;
  draft.size = {side(options.size.width), side(options.size.height)};
  draft.quality = Quality::kDraft;
  draft.depth_cue = DepthCue::kNone;
  SPLATLAS_ASSIGN_OR_RETURN(const Camera whole, renderer.fit(camera, draft));
  SPLATLAS_ASSIGN_OR_RETURN(const Picture picture, renderer.render(whole, draft));
  std::vector<NamedStructure> structures = structures_of(renderer, selection, picture);
  for (NamedStructure& one : structures) one.visible.pixels /= scale * scale;
  return structures;
}

}  // namespace

Result<AnnotationItems> parse_annotations(std::string_view text) {
  AnnotationItems items;
  while (true) {
    const std::size_t comma = std::min(text.find(','), text.size());
    const std::string_view name = text.substr(0, comma);
    const auto found = std::ranges::find(kItems, name, &Item::first);
    if (found == kItems.end() && name != kAll) {
      return fail(ErrorCode::kUsage, "{} is no annotation; use {}, separated by commas",
                  in_quotes(std::string(name)), item_names());
    }
    for (const auto& [other, member] : kItems) items.*member |= name == kAll || name == other;
    if (comma == text.size()) return items;
    text.remove_prefix(comma + 1);
  }
}

void add_annotations(CLI::App& command, AnnotateRequest& request) {
  const auto parse = [&request](const std::string& text) {
    const auto items = parse_annotations(text);
    if (!items) throw CLI::ValidationError("--annotate", items.error().message);
    request.items = *items;
  };
  CLI::Option* annotate = command.add_option_function<std::string>(
      "--annotate", parse, item_names() + ", separated by commas: items to draw over the picture");
  const auto needs_it = [&](CLI::Option* option) { option->needs(annotate); };
  const auto line = [](std::string_view text) {
    return printable(text) == text ? std::optional<std::string>(text) : std::nullopt;
  };
  needs_it(add_parsed(command, "--caption", request.caption, line, "must be one line of UTF-8 text",
                      "text below the picture; default: the title of the atlas"));
  const auto labels = [](std::string_view text) { return number_within<std::size_t>(text, 0, 1000); };
  needs_it(add_parsed(command, "--max-labels", request.max_labels, labels, "must be a number from 0 to 1000",
                      "names the largest structures only")
               ->default_str(fmt::to_string(request.max_labels)));
  const auto font = [](std::string_view text) {
    return text.empty() ? std::nullopt : std::optional<std::filesystem::path>(text);
  };
  needs_it(add_parsed(command, "--font", request.font, font, "must name a file",
                      "font file of the annotations; default: Liberation Sans, or DejaVu Sans"));
  const auto dpi = [](std::string_view text) { return number_within<double>(text, kMinDpi, kMaxDpi); };
  add_parsed(command, "--dpi", request.dpi, dpi,
             fmt::format("must be a number from {} to {}", kMinDpi, kMaxDpi),
             "pixels per inch in print; A4 at 300: --size 2480x3508, or 3508x2480");
}

Result<PictureRegion> region_beside_annotations(Renderer& renderer, const Selection& selection,
                                                const Camera& camera, const RenderOptions& options,
                                                const AnnotateRequest& request, TextDrawer& drawer) {
  const Picture blank{options.size, {}};
  Camera whole = camera;
  whole.zoom = 1;
  whole.center_lps_mm.reset();
  SPLATLAS_ASSIGN_OR_RETURN(const View view, view_of(whole, options.size, renderer.atlas().display()));
  AnnotatedScene scene{blank, view};
  if (request.items.labels || request.items.legend) {
    SPLATLAS_ASSIGN_OR_RETURN(scene.structures, structures_of_draft(renderer, selection, whole, options));
  }
  SPLATLAS_RETURN_IF_ERROR(drawer.wait());
  return region_of_figure(scene, options_of(request, renderer.atlas().provenance()), measure_with(drawer));
}

Result<AnnotationLayer> annotate_rendered(const Renderer& renderer, const Selection& selection,
                                          const Picture& picture, const View& view,
                                          std::optional<Rgb> background, const AnnotateRequest& request,
                                          TextDrawer& drawer) {
  AnnotatedScene scene{picture, view, background};
  if (request.items.labels || request.items.legend)
    scene.structures = structures_of(renderer, selection, picture);
  SPLATLAS_RETURN_IF_ERROR(drawer.wait());
  const AnnotationOptions options = options_of(request, renderer.atlas().provenance());
  SPLATLAS_ASSIGN_OR_RETURN(AnnotationLayer layer, annotate_picture(scene, options, measure_with(drawer)));
  if (request.items.caption && options.caption.empty()) {
    layer.notes.emplace_back("the atlas has no title; give a caption with --caption TEXT");
  }
  if (request.items.citation && options.citation.empty()) {
    layer.notes.emplace_back("the atlas has no citation; build it with --citation TEXT");
  }
  return layer;
}

}  // namespace splatlas
