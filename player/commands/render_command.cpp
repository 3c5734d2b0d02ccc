#include "player/commands/render_command.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <span>
#include <string_view>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "format/io/output_file.h"
#include "format/io/output_path.h"
#include "format/program/command_options.h"
#include "format/result_macros.h"
#include "format/tasks/task_control.h"
#include "format/text/ascii_text.h"
#include "format/text/json_text.h"
#include "player/camera_moves.h"
#include "player/commands/annotate_options.h"
#include "player/files/picture_encoder.h"
#include "player/web/render_warnings.h"
#include "player/write_picture.h"

namespace splatlas {
namespace {

constexpr const char* kRenderFooter =
    "Selection text: terms joined by '+', removals by '-':\n"
    "  NAME[:surface|:volume|:both][(opacity=0.4,color=#ff8800)]\n"
    "NAME is a structure's id, name or path (Brain/Cerebellum/Left), '*' stands for any characters.\n"
    "Quote names that contain spaces, operators or colons. A group selects its descendants.\n"
    "#17 in place of NAME is the structure with label 17; rest is everything that no other term names.\n"
    "The default mode is volume; 'both' is a volume with its surface.\n"
    "Options; the last four are for volumes only:\n"
    "  ghost                  of surfaces: one thin grey hull of all in the term, denser at its rim\n"
    "  opacity=0.4            of a surface, or of one voxel of a volume: above 0, at most 1\n"
    "  color=#ff8800\n"
    "  low=40, high=160       grey values between which a volume rises to its opacity\n"
    "  profile=soft           a ramp from low to high; thin: opacity 0.01 by default; hard: a step\n"
    "  curve=40:0/160:0.3     a table of grey:opacity or grey:opacity:shade, instead of a ramp\n"
    "\n"
    "  --select '\"Left hemisphere\":volume + Cerebellum:surface(opacity=0.5) - Vermis*'\n"
    "\n"
    "Annotations are sized for print: at --dpi 300, a picture of 3508x2480 pixels is an A4 page with texts "
    "of\n"
    "7 to 13 points. --fit leaves room for them:\n"
    "  --annotate labels,legend,scalebar --size 3508x2480 --dpi 300 --background '#ffffff'\n"
    "\n"
    "Exit status: 0 done; 1 could not be done; 2 wrong usage; 3 not a valid atlas; 4 name not found.";

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

std::optional<double> parse_angle(std::string_view text) {
  const auto degrees = parse_number<double>(text);
  return degrees && std::isfinite(*degrees) ? degrees : std::nullopt;
}

std::optional<double> parse_zoom(std::string_view text) {
  const auto zoom = parse_number<double>(text);
  return zoom && *zoom >= kMinZoom && *zoom <= kMaxZoom ? zoom : std::nullopt;
}

void add_cuts(CLI::App& command, RenderOptions& options, bool& names_caps) {
  const auto append = [&options](const std::vector<std::string>& texts) {
    for (const std::string& text : texts) {
      const auto plane = parse_cut(text);
      if (!plane) throw CLI::ValidationError(fmt::format("--cut {}", in_quotes(text)), kCutForms);
      if (options.cuts.size() == CutPlanes::kMax) {
        throw CLI::ValidationError(fmt::format("--cut {}", in_quotes(text)),
                                   fmt::format("is one too many; at most {} cuts", CutPlanes::kMax));
      }
      if (!options.cuts.add(*plane)) {
        throw CLI::ValidationError(fmt::format("--cut {}", in_quotes(text)),
                                   "must have finite numbers and a normal other than 0");
      }
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

nlohmann::ordered_json missing_json(std::span<const MissingPart> missing, const StructureGraph& graph) {
  auto json = nlohmann::ordered_json::array();
  for (const MissingPart& part : missing) {
    json.push_back({{"structure", graph[part.structure].id},
                    {"part", part.surface ? "surface" : "volume"},
                    {"voxels", part.voxels},
                    {"why", part.error.message}});
  }
  return json;
}

/// Ids of the structures in an id image, by number.
nlohmann::ordered_json ids_json(const IdImage& ids, const StructureGraph& graph) {
  auto json = nlohmann::ordered_json::object();
  std::vector<bool> is_shown(graph.size() + 1);
  for (const StructureNumber number : ids.numbers) is_shown[number] = true;
  for (std::size_t number = 1; number <= graph.size(); ++number) {
    if (is_shown[number]) json[std::to_string(number)] = graph[static_cast<StructureIndex>(number - 1)].id;
  }
  return json;
}

nlohmann::ordered_json stats_json(const Frame& frame, const Atlas& atlas, double open_ms) {
  const RenderStats& stats = frame.stats;
  const Atlas::Counters bytes = atlas.counters();
  nlohmann::ordered_json json{
      {"voxels",
       {{"volume", stats.volume_voxels}, {"surface", stats.surface_voxels}, {"hybrid", stats.hybrid_voxels}}},
      {"occupancy", stats.occupancy},
      {"runs_visited", stats.runs_visited},
      {"voxels_visited", stats.voxels_visited},
      {"triangles", stats.triangles},
      {"bytes", {{"file", bytes.file}, {"read", bytes.read}, {"decoded", bytes.decoded}}},
      {"ms",
       {{"open", open_ms},
        {"select", stats.select_ms},
        {"decode", stats.decode_ms},
        {"render", stats.render_ms}}},
      {"missing", missing_json(frame.missing, atlas.graph())}};
  if (!frame.ids.empty()) json["ids"] = ids_json(frame.ids, atlas.graph());
  return json;
}

/// Names the option of a camera's parameter that the renderer refuses.
Error with_option(Error error) {
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 2> kOptions{
      {{"camera: field of view", "--field-of-view"}, {"camera: zoom", "--zoom"}}};
  for (const auto& [subject, option] : kOptions) {
    if (error.subject == subject) error.message.replace(0, subject.size(), option);
  }
  return error;
}

/// Writes all files or none.
Result<void> write_outputs(const RenderRequest& request, std::span<const std::byte> picture,
                           const std::string& stats, const Frame& frame) {
  std::vector<OutputFile> files;
  if (!request.ids.empty()) {
    SPLATLAS_ASSIGN_OR_RETURN(const std::vector<std::byte> bytes, encode_ids(frame.ids, request.ids));
    SPLATLAS_RETURN_IF_ERROR(add_file(request.ids, bytes, files));
  }
  if (!request.depth.empty()) {
    SPLATLAS_ASSIGN_OR_RETURN(const std::vector<std::byte> bytes, encode_depths(frame.depths, request.depth));
    SPLATLAS_RETURN_IF_ERROR(add_file(request.depth, bytes, files));
  }
  if (!request.stats.empty())
    SPLATLAS_RETURN_IF_ERROR(add_file(request.stats, std::as_bytes(std::span(stats)), files));
  SPLATLAS_RETURN_IF_ERROR(add_file(request.output, picture, files));
  return commit_files(files);
}

/// Endings of the outputs, and that they can be written and are no inputs.
Result<void> check_files(const RenderRequest& request) {
  SPLATLAS_RETURN_IF_ERROR(PictureEncoder::check_ending(request.output));
  if (!request.ids.empty()) SPLATLAS_RETURN_IF_ERROR(check_id_ending(request.ids));
  if (!request.depth.empty()) SPLATLAS_RETURN_IF_ERROR(check_depth_ending(request.depth));
  const std::vector outputs{request.output, request.stats, request.ids, request.depth};
  SPLATLAS_RETURN_IF_ERROR(check_outputs(outputs, std::vector{request.atlas, request.page.font}));
  for (const std::filesystem::path& path : outputs)
    if (!path.empty()) SPLATLAS_RETURN_IF_ERROR(check_writable_file(path));
  return {};
}

}  // namespace

CLI::App* add_render(CLI::App& app, RenderRequest& request) {
  CLI::App* command = app.add_subcommand("render", "Render a selection to a picture file, without a window");
  command->add_option("ATLAS", request.atlas, "atlas file")->required()->check(names_a_file());
  add_parsed(*command, "-o,--output", request.output, non_empty<std::filesystem::path>, "must name a file",
             "picture: .png, .jpg, .tif, .exr (linear float RGBA), or .svg and .pdf (vector annotations)")
      ->required();
  CLI::Option* select =
      command->add_option("--select", request.select, "selection text (see below)")->capture_default_str();
  CLI::Option* scene =
      add_parsed(*command, "--scene", request.scene, non_empty<std::string>, "must name a scene",
                 "a named view of the atlas: its selection, camera, cuts, labels and caption; other options "
                 "are as given")
          ->excludes(select);
  add_parsed(
      *command, "--size", request.page.render.size, parse_size,
      fmt::format("must be WIDTHxHEIGHT in pixels, each from 1 to {}, as in 1024x768", kMaxPictureSide),
      "WIDTHxHEIGHT in pixels")
      ->default_str(fmt::format("{}x{}", request.page.render.size.width, request.page.render.size.height));
  add_camera(*command, request.camera, request.names_projection);
  for (const char* option : {"--view", "--azimuth", "--elevation"})
    scene->excludes(command->get_option(option));
  add_framing(*command, request.page.fits_selection, request.center);
  add_quality(*command, request.page.render);
  add_cuts(*command, request.page.render, request.names_caps);
  const CLI::Option* background =
      add_parsed(*command, "--background", request.background, parse_background,
                 "must be #rrggbb, #rrggbb,#rrggbb or transparent",
                 "#rrggbb; two of them, top and bottom of a gradient; or transparent. .jpg: black by default")
          ->default_str(to_hex(*request.background[0]));
  command->parse_complete_callback([&request, background] {
    if (background->count() == 0 || request.background[0] || !PictureEncoder::is_opaque(request.output))
      return;
    throw CLI::ValidationError("--background \"transparent\"",
                               "a .jpg picture has no transparency; write .png, .tif or .exr");
  });
  add_choice(*command, "--outline", request.page.outlines, {{"none", false}, {"edges", true}},
             "dark lines around structures and at folds");
  add_annotations(*command, request.page);
  add_threads(*command, request.renderer.threads, "0: one per core; the picture does not depend on it");
  add_memory(*command, request.renderer.max_memory_bytes);
  add_surfaces(*command, request.atlas_options.surfaces,
               "surfaces that follow from the voxels; as in the atlas if not given");
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
  command->footer(kRenderFooter);
  return command;
}

namespace {

/// Selection, caption, camera, cuts and labels of a picture.
struct Shown {
  std::string select, caption;
  Camera camera;  ///< its zoom is relative to the fit
  CutPlanes cuts;
  std::vector<bool> labelled = {};
};

/// Takes them from the scene. Options that are given replace its values.
Result<Shown> shown_by(const RenderRequest& request, const Atlas& atlas) {
  Shown shown{.select = request.select, .caption = {}, .camera = request.camera, .cuts = {}};
  if (!request.scene.empty()) {
    SPLATLAS_ASSIGN_OR_RETURN(const Scene scene, find_scene(request.scene, atlas));
    SPLATLAS_ASSIGN_OR_RETURN(const SceneFraming framing, framing_of(scene, atlas));
    shown.select = scene.selection;
    shown.caption = scene.caption;
    shown.cuts = framing.cuts;
    shown.labelled = framing.labelled;
    shown.camera.azimuth_deg = scene.azimuth_deg;
    shown.camera.elevation_deg = scene.elevation_deg;
    shown.camera.zoom *= scene.zoom;
    if (!request.names_projection && scene.perspective)
      shown.camera.projection = CameraProjection::kPerspective;
    shown.camera.center_lps_mm = framing.center_lps_mm;
  }
  if (!request.page.render.cuts.empty()) shown.cuts = request.page.render.cuts;
  const Result<std::optional<Vec3>> center = center_of(request.center, atlas);
  if (!center) return fail(center.error().code, "{}: --center: {}", atlas.name(), center.error().message);
  if (*center) shown.camera.center_lps_mm = *center;
  return shown;
}

}  // namespace

Result<RenderReport> run_render(const RenderRequest& request, const RenderControl& control) {
  // Report errors that do not need the atlas before opening it
  PageOptions options = request.page;
  options.render.ids = !request.ids.empty();
  options.render.depths = !request.depth.empty();
  options.background = request.background[0];
  options.background_bottom = request.background[1];
  SPLATLAS_RETURN_IF_ERROR(check_files(request));
  SPLATLAS_RETURN_IF_ERROR(parse_selection(request.select));
  SPLATLAS_RETURN_IF_ERROR(view_of(request.camera, options.render.size, Display{}).map_error(with_option));
  SPLATLAS_ASSIGN_OR_RETURN(PageRenderer pages, PageRenderer::create(request.output, options));

  // Open the atlas and select
  const auto start = std::chrono::steady_clock::now();
  SPLATLAS_ASSIGN_OR_RETURN(std::shared_ptr<const Atlas> atlas,
                            Atlas::open(request.atlas, request.atlas_options));
  const TaskControl task({}, {}, &atlas->work_budget());  // of all steps together
  const double open_ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  SPLATLAS_ASSIGN_OR_RETURN(const Shown shown, shown_by(request, *atlas));
  pages.set_cuts(shown.cuts);
  pages.set_labelled(shown.labelled);
  if (!options.caption && !shown.caption.empty()) pages.set_caption(shown.caption);
  const auto named = [&](const Error& error) { return in_selection(error, *atlas, request.scene); };
  SPLATLAS_ASSIGN_OR_RETURN(const auto terms, parse_selection(shown.select).map_error(named));
  SPLATLAS_ASSIGN_OR_RETURN(const Selection selection,
                            resolve_selection(terms, atlas->graph()).map_error(named));
  RenderReport report;
  SPLATLAS_ASSIGN_OR_RETURN(report.warnings, selection_warnings(terms, *atlas));
  Renderer renderer(atlas, request.renderer);
  SPLATLAS_RETURN_IF_ERROR(renderer.select(selection));

  // Render and write
  SPLATLAS_ASSIGN_OR_RETURN(Page page, pages.render(renderer, shown.camera, control).map_error(with_option));
  const std::string nothing = emptiness_of(page.frame);
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<std::byte> picture, pages.encode(page));
  SPLATLAS_RETURN_IF_ERROR(
      write_outputs(request, picture, json_text(stats_json(page.frame, *atlas, open_ms)), page.frame));
  if (!nothing.empty()) report.warnings.push_back(nothing);
  if (request.names_caps && shown.cuts.empty())
    report.warnings.emplace_back("--cap has no effect without --cut");
  report.notes = std::move(page.annotations.notes);
  for (const MissingPart& part : page.frame.missing) report.missing.push_back(describe(part, atlas->graph()));
  return report;
}

}  // namespace splatlas
