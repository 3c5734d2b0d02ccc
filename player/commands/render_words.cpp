#include "player/commands/render_words.h"

#include <charconv>
#include <optional>
#include <string_view>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "format/system/ascii_text.h"
#include "format/system/result_macros.h"
#include "player/commands/option_names.h"

namespace splatlas {
namespace {

constexpr const char* kFooter =
    "Selection text: terms joined by '+', removals by '-':\n"
    "  NAME[:surface|:volume|:both][(opacity=0.4,color=#ff8800)]\n"
    "NAME is a structure's id, name or path (Brain/Cerebellum/Left), '*' stands for any characters;\n"
    "quote it where it holds a blank, a sign or a colon. A node selects all its descendants.\n"
    "Options, for volumes the last four only:\n"
    "  opacity=0.4            above 0, at most 1; of a surface, or of one voxel of a volume\n"
    "  color=#ff8800\n"
    "  low=40, high=160       grey values between which a volume rises to its opacity\n"
    "  profile=soft           a ramp from low to high; thin: opacity 0.01 by default; hard: a step\n"
    "  curve=40:0/160:0.3     no ramp but a table of grey:opacity or grey:opacity:shade\n"
    "\n"
    "  --select '\"Left hemisphere\":volume + Cerebellum:surface(opacity=0.5) - Vermis*'\n"
    "\n"
    "Exit status: 0 done; 1 could not be done; 2 wrong usage; 3 not a valid atlas; 4 name not found.";

tl::unexpected<Error> refuse(std::string_view option, std::string_view text, std::string_view what_to_do) {
  return fail(ErrorCode::kUsage, fmt::format("{} {}: {}", option, in_quotes(text), what_to_do));
}

/// The whole text as a number: no blanks before or after it.
template <typename Number>
std::optional<Number> whole_number(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

Result<double> parse_number(std::string_view option, const std::string& text) {
  const auto number = whole_number<double>(text);
  if (!number) return refuse(option, text, "must be a number");
  return *number;
}

Result<PictureSize> parse_size(const std::string& text) {
  const std::size_t x = text.find('x');
  const auto width = whole_number<int>(std::string_view(text).substr(0, x));
  const auto height = whole_number<int>(x == std::string::npos ? "" : std::string_view(text).substr(x + 1));
  if (!width || !height) return refuse("--size", text, "must be WIDTHxHEIGHT in pixels, as in 1024x768");
  return PictureSize{*width, *height};
}

Result<Camera> parse_camera(const CLI::App& command, const RenderWords& words) {
  Camera camera;
  const auto projection = named_projection(words.projection);
  if (!projection) return refuse("--projection", words.projection, "must be parallel or perspective");
  camera.projection = *projection;
  if (command.count("--view") > 0) {
    const auto view = named_view(words.view);
    if (!view) {
      return refuse("--view", words.view, "must be anterior, posterior, left, right, superior or inferior");
    }
    camera = Camera::of(*view);
    camera.projection = *projection;
  }
  if (command.count("--azimuth") > 0) {
    SPLATLAS_ASSIGN_OR_RETURN(camera.azimuth_deg, parse_number("--azimuth", words.azimuth));
  }
  if (command.count("--elevation") > 0) {
    SPLATLAS_ASSIGN_OR_RETURN(camera.elevation_deg, parse_number("--elevation", words.elevation));
  }
  SPLATLAS_ASSIGN_OR_RETURN(camera.zoom, parse_number("--zoom", words.zoom));
  SPLATLAS_ASSIGN_OR_RETURN(camera.field_of_view_deg, parse_number("--field-of-view", words.field_of_view));
  if (command.count("--field-of-view") > 0 && *projection == CameraProjection::kParallel) {
    return refuse("--field-of-view", words.field_of_view, "has a meaning with --projection perspective only");
  }
  return camera;
}

Result<RenderOptions> parse_options(const RenderWords& words) {
  RenderOptions options;
  SPLATLAS_ASSIGN_OR_RETURN(options.size, parse_size(words.size));
  const auto quality = named_quality(words.quality);
  if (!quality) return refuse("--quality", words.quality, "must be draft, normal or high");
  options.quality = *quality;
  const auto classification = named_classification(words.classify);
  if (!classification) return refuse("--classify", words.classify, "must be before or after");
  options.classification = *classification;
  options.hybrid_shading = words.shading == "hybrid";
  if (words.shading != "hybrid" && words.shading != "none") {
    return refuse("--shading", words.shading, "must be hybrid or none");
  }
  const auto depth_cue = named_depth_cue(words.depth_cue);
  if (!depth_cue) return refuse("--depth-cue", words.depth_cue, "must be none or edges");
  options.depth_cue = *depth_cue;
  return options;
}

}  // namespace

CLI::App* add_render(CLI::App& app, RenderWords& words) {
  CLI::App* command = app.add_subcommand("render", "Render a selection to a picture file, without a window");
  command->add_option("ATLAS", words.atlas, "atlas file")->required();
  command->add_option("-o,--output", words.output, "picture: .png, .jpg, .tif, or .exr (linear float RGBA)")
      ->required();
  command->add_option("--select", words.select, "selection text (see below)")->capture_default_str();
  command->add_option("--size", words.size, "WIDTHxHEIGHT in pixels")->capture_default_str();
  command->add_option("--view", words.view, "anterior, posterior, left, right, superior or inferior");
  command->add_option("--azimuth", words.azimuth,
                      "degrees around the superior axis: 0 anterior, 90 the subject's left");
  command->add_option("--elevation", words.elevation, "degrees above the horizon");
  command->add_option("--zoom", words.zoom, "1 fits the atlas into the picture")->capture_default_str();
  command->add_option("--projection", words.projection, "parallel or perspective")->capture_default_str();
  command
      ->add_option("--field-of-view", words.field_of_view, "degrees of the picture's height, in perspective")
      ->capture_default_str();
  command
      ->add_option("--classify", words.classify,
                   "transfer functions before or after interpolation between voxels")
      ->capture_default_str();
  command->add_option("--quality", words.quality, "draft, normal or high")->capture_default_str();
  command->add_option("--shading", words.shading, "hybrid: boundary voxels are lit by their normals; none")
      ->capture_default_str();
  command
      ->add_option("--depth-cue", words.depth_cue,
                   "edges: what lies behind something near it is darker there, and so are furrows; none")
      ->capture_default_str();
  command->add_option("--background", words.background, "#rrggbb or transparent")->capture_default_str();
  command->add_option("--threads", words.threads, "0: one per core; the picture does not depend on it")
      ->capture_default_str();
  command->add_option("--stats", words.stats, "write what was visited and read, and times, to a JSON file");
  command->footer(kFooter);
  return command;
}

Result<RenderRequest> render_request(const CLI::App& command, const RenderWords& words) {
  RenderRequest request;
  request.atlas = words.atlas;
  if (words.output.empty()) return refuse("--output", words.output, "must name a file");
  request.output = words.output;
  request.select = words.select;
  if (command.count("--stats") > 0 && words.stats.empty()) {
    return refuse("--stats", words.stats, "must name a file");
  }
  request.stats = words.stats;
  SPLATLAS_ASSIGN_OR_RETURN(request.options, parse_options(words));
  SPLATLAS_ASSIGN_OR_RETURN(request.camera, parse_camera(command, words));
  SPLATLAS_ASSIGN_OR_RETURN(request.threads, parse_threads(words.threads));
  if (words.background == "transparent") {
    request.background.reset();
  } else {
    const auto color = parse_color(words.background);
    if (!color) return refuse("--background", words.background, "must be #rrggbb or transparent");
    request.background = *color;
  }
  return request;
}

Result<unsigned> parse_threads(const std::string& text) {
  constexpr unsigned kMost = 1024;
  const auto threads = whole_number<unsigned>(text);
  if (!threads || *threads > kMost) {
    return refuse("--threads", text, fmt::format("must be a whole number from 0 to {}", kMost));
  }
  return *threads;
}

}  // namespace splatlas
