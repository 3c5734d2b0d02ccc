#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "format/program/command_options.h"
#include "format/result_macros.h"
#include "format/text/ascii_text.h"
#include "player/commands/commands.h"
#include "player/files/picture_encoder.h"

namespace splatlas {
namespace {

constexpr const char* kRenderFooter =
#include "player/commands/render_help.txt"
    ;

using Background = std::array<std::optional<Rgb>, 2>;

std::optional<PictureSize> parse_size(std::string_view text) {
  const std::size_t x = std::min(text.find('x'), text.size());
  const auto width = parse_number<int>(text.substr(0, x));
  const auto height = parse_number<int>(text.substr(std::min(x + 1, text.size())));
  const auto is_side = [](std::optional<int> side) { return side && *side >= 1 && *side <= kMaxPictureSide; };
  if (!is_side(width) || !is_side(height)) return std::nullopt;
  return PictureSize{*width, *height};
}

std::optional<Background> parse_background(std::string_view text) {
  if (text == "transparent") return Background();
  const std::size_t comma = std::min(text.find(','), text.size());
  const auto top = parse_color(text.substr(0, comma));
  if (!top) return std::nullopt;
  if (comma == text.size()) return Background{*top};
  const auto bottom = parse_color(text.substr(comma + 1));
  return bottom ? std::optional(Background{*top, *bottom}) : std::nullopt;
}

template <typename Number>
std::optional<Number> number_within(std::string_view text, Number min, Number max) {
  const auto number = parse_number<Number>(text);
  return number && *number >= min && *number <= max ? number : std::nullopt;
}

void add_cuts(CLI::App& command, RenderOptions& options, bool& names_caps) {
  const auto append = [&options](const std::vector<std::string>& texts) {
    for (const std::string& text : texts) {
      const auto refuse = [&](const std::string& why) {
        throw CLI::ValidationError(fmt::format("--cut {}", in_quotes(text)), why);
      };
      const auto plane = parse_cut(text);
      if (!plane) refuse(kCutForms);
      if (options.cuts.size() == CutPlanes::kMax)
        refuse(fmt::format("is one too many; at most {} cuts", CutPlanes::kMax));
      if (!options.cuts.add(plane.value())) refuse("must have finite numbers and a normal other than 0");
    }
  };
  command.add_option_function<std::vector<std::string>>(
      "--cut", append,
      "SIDE=MM removes what lies further to that side of the origin; NX,NY,NZ,D removes n.p > D (LPS mm); "
      "up to six");
  add_choice(command, "--cap", options.caps,
             {{"values", CapMode::kValues},
              {"labels", CapMode::kLabels},
              {"both", CapMode::kBoth},
              {"none", CapMode::kNone}},
             "faces of cuts: grey values, structure colours, tinted grey values or hollow")
      ->each([&names_caps](const std::string&) { names_caps = true; });
}

/// Adds camera options. CLI11 assigns values in this order, so single settings override --view.
void add_camera(CLI::App& command, Camera& camera, bool& names_projection) {
  add_view(command, camera);
  const auto parse_angle = [](std::string_view text) { return number_within<double>(text, -1e300, 1e300); };
  const auto parse_zoom = [](std::string_view text) { return number_within(text, kMinZoom, kMaxZoom); };
  constexpr const char* kFiniteAngle = "must be a finite angle in degrees";
  add_parsed(command, "--azimuth", camera.azimuth_deg, parse_angle, kFiniteAngle,
             "degrees around the superior axis: 0 anterior, 90 the subject's left; overrides --view");
  add_parsed(command, "--elevation", camera.elevation_deg, parse_angle, kFiniteAngle,
             "degrees above the horizon; overrides --view");
  add_parsed(command, "--zoom", camera.zoom, parse_zoom, "must be a number from 1e-6 to 1e6",
             "multiplies the zoom of --fit, around its centre or --center")
      ->default_str(fmt::to_string(camera.zoom));
  add_choice(command, "--projection", camera.projection,
             {{"parallel", CameraProjection::kParallel}, {"perspective", CameraProjection::kPerspective}})
      ->each([&names_projection](const std::string&) { names_projection = true; });
  const CLI::Option* field_of_view =
      add_parsed(command, "--field-of-view", camera.field_of_view_deg, parse_number<double>,
                 "must be a number of degrees",
                 "vertical field of view in degrees, with --projection perspective")
          ->default_str(fmt::to_string(camera.field_of_view_deg));
  command.final_callback([&camera, field_of_view] {
    if (field_of_view->count() == 0 || camera.projection == CameraProjection::kPerspective) return;
    throw CLI::ValidationError("--field-of-view", "needs --projection perspective");
  });
}

void add_quality(CLI::App& command, RenderOptions& options) {
  add_choice(command, "--classify", options.classification,
             {{"before", Classification::kBefore}, {"after", Classification::kAfter}},
             "transfer functions relative to interpolation between voxels");
  add_choice(command, "--quality", options.quality,
             {{"draft", Quality::kDraft}, {"normal", Quality::kNormal}, {"high", Quality::kHigh}});
  add_choice(command, "--shading", options.hybrid_shading, {{"hybrid", true}, {"none", false}},
             "light volumes by their borders and grey values");
  add_choice(command, "--depth-cue", options.depth_cue,
             {{"none", DepthCue::kNone}, {"edges", DepthCue::kEdges}},
             "darken pixels that lie behind their neighbours");
}

using Item = std::pair<std::string_view, bool AnnotationItems::*>;
constexpr std::array kItems{
    Item{"labels", &AnnotationItems::labels},      Item{"legend", &AnnotationItems::legend},
    Item{"scalebar", &AnnotationItems::scale_bar}, Item{"orientation", &AnnotationItems::orientation},
    Item{"caption", &AnnotationItems::caption},    Item{"citation", &AnnotationItems::citation}};
constexpr std::string_view kAll = "all";

std::string item_names() {
  std::string names;
  for (const auto& [name, member] : kItems) names += std::string(name) + ", ";
  return names + "or " + std::string(kAll);
}

/// Parses a list of items: "labels,legend". kUsage, with the valid names.
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

void add_annotations(CLI::App& command, PageOptions& options) {
  const auto parse = [&options](const std::string& text) {
    const auto items = parse_annotations(text);
    if (!items) throw CLI::ValidationError("--annotate", items.error().message);
    options.items = *items;
  };
  CLI::Option* annotate = command.add_option_function<std::string>(
      "--annotate", parse, item_names() + ", separated by commas: items to draw over the picture");
  const auto needs_it = [&](CLI::Option* option) { option->needs(annotate); };
  const auto line = [](std::string_view text) {
    return printable(text) == text ? std::optional<std::string>(text) : std::nullopt;
  };
  needs_it(add_parsed(command, "--caption", options.caption, line,
                      "must be one line of visible UTF-8 characters",
                      "text below the picture; default: that of --scene, or the title of the atlas"));
  const auto labels = [](std::string_view text) { return number_within<std::size_t>(text, 0, 1000); };
  needs_it(add_parsed(command, "--max-labels", options.max_labels, labels, "must be a number from 0 to 1000",
                      "names the largest structures only")
               ->default_str("40"));
  needs_it(add_parsed(command, "--font", options.font, non_empty<std::filesystem::path>, "must name a file",
                      "font file of the annotations; others stand in for letters that it lacks"));
  const auto dpi = [](std::string_view text) { return number_within<double>(text, kMinDpi, kMaxDpi); };
  add_parsed(command, "--dpi", options.dpi, dpi,
             fmt::format("must be a number from {} to {}", kMinDpi, kMaxDpi),
             "pixels per inch in print; A4 at 300: --size 2480x3508, or 3508x2480");
}

/// Adds --scenes, --turn and --frames after the options that they exclude.
void add_sequences(CLI::App& command, RenderRequest& request) {
  CLI::Option* const scenes =
      add_parsed(command, "--scenes", request.output, non_empty<std::filesystem::path>, "must name a folder",
                 "in place of -o: new folder with a picture of every scene, handout.html and handout.pdf, "
                 "which have the captions")
          ->each([&request](const std::string&) { request.all_scenes = true; });
  CLI::Option* const turn =
      command
          .add_option("--turn", request.turn_deg,
                      "degrees that the camera turns in all, from 0001.png in the folder of -o")
          ->check(CLI::Range(-36000.0, 36000.0).description(""));
  turn->needs(command.add_option("--frames", request.frames, "pictures of --turn, from 2 to 10000")
                  ->check(CLI::Range(2, 10000).description(""))
                  ->needs(turn));
  for (const char* option : {"--stats", "--ids", "--depth"})
    scenes->excludes(command.get_option(option)), turn->excludes(command.get_option(option));
  for (const char* option :
       {"--output", "--scene", "--select", "--view", "--azimuth", "--elevation", "--caption", "--turn"})
    scenes->excludes(command.get_option(option));
}

}  // namespace

CLI::App* add_render(CLI::App& app, RenderRequest& request) {
  CLI::App* command = app.add_subcommand("render", "Render a selection to a picture file, without a window");
  add_path(*command, "ATLAS", request.atlas, "atlas file")->required();
  add_parsed(*command, "-o,--output", request.output, non_empty<std::filesystem::path>, "must name a file",
             "picture: .png, .jpg, .tif, .exr (linear float RGBA), or .svg and .pdf (vector annotations); - "
             "writes a PNG to standard output; with --turn a new folder");
  CLI::Option* select =
      command->add_option("--select", request.select, "selection text (see below)")->capture_default_str();
  CLI::Option* scene =
      add_parsed(*command, "--scene", request.scene, non_empty<std::string>, "must name a scene",
                 "a named view of the atlas: its selection, camera, cuts, labels and caption; other options "
                 "are as given")
          ->excludes(select);
  const CLI::Option* size =
      add_parsed(
          *command, "--size", request.page.render.size, parse_size,
          fmt::format("must be WIDTHxHEIGHT in pixels, each from 1 to {}, as in 1024x768", kMaxPictureSide),
          "WIDTHxHEIGHT in pixels; --scenes: 1600x1200 by default")
          ->default_str(
              fmt::format("{}x{}", request.page.render.size.width, request.page.render.size.height));
  add_camera(*command, request.camera, request.names_projection);
  for (const char* option : {"--view", "--azimuth", "--elevation"})
    scene->excludes(command->get_option(option));
  add_framing(*command, request.page.fits_selection, request.center);
  add_quality(*command, request.page.render);
  add_cuts(*command, request.page.render, request.names_caps);
  const CLI::Option* background = add_parsed(*command, "--background", request.background, parse_background,
                                             "must be #rrggbb, #rrggbb,#rrggbb or transparent",
                                             "#rrggbb; two of them, top and bottom of a gradient; or "
                                             "transparent. .jpg: black by default; --scenes: white")
                                      ->default_str(to_hex(*request.background[0]));
  command->parse_complete_callback([&request, background, size] {
    if (request.output.empty()) throw CLI::RequiredError("--output or --scenes");
    if (request.all_scenes) {
      request.page.items.caption = false;  // the handout has it
      if (size->count() == 0) request.page.render.size = {1600, 1200};
      if (background->count() == 0) request.background[0] = Rgb{255, 255, 255};
    }
    if (background->count() == 0 || request.background[0] || !PictureEncoder::is_opaque(request.output))
      return;
    throw CLI::ValidationError("--background \"transparent\"",
                               "a .jpg picture has no transparency; write .png, .tif or .exr");
  });
  add_choice(*command, "--palette", request.distinct_colors, {{"atlas", false}, {"distinct", true}},
             "colours of structures without a color= of their own: those of the atlas, or such that keep "
             "neighbours apart, also for colour-blind eyes");
  add_choice(*command, "--outline", request.page.outlines, {{"none", false}, {"edges", true}},
             "dark lines around structures and at folds");
  add_annotations(*command, request.page);
  add_threads(*command, request.renderer.threads, "0: one per core; the picture does not depend on it");
  add_memory(*command, request.renderer.max_memory_bytes);
  add_surfaces(*command, request.atlas_options.surfaces);
  add_max_work(*command, request.atlas_options.max_work);
  add_parsed(*command, "--stats", request.stats, non_empty<std::filesystem::path>, "must name a file",
             "JSON file to write: voxels visited, bytes read, times");
  add_parsed(
      *command, "--ids", request.ids, non_empty<std::filesystem::path>, "must name a file",
      "id image to write, .png (16-bit grey) or .exr: the number of the structure that each pixel shows; "
      "--stats lists the numbers");
  add_parsed(
      *command, "--depth", request.depth, non_empty<std::filesystem::path>, "must name a file",
      "depth map to write, .exr: mm from the plane through the picture's centre towards the eye, NaN for "
      "background");
  add_sequences(*command, request);
  command->footer(kRenderFooter);
  return command;
}

}  // namespace splatlas
