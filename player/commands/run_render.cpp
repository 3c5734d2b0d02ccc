#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <memory>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "format/io/output_file.h"
#include "format/program/standard_output.h"
#include "format/result_macros.h"
#include "format/tasks/task_control.h"
#include "format/text/json_text.h"
#include "player/camera_moves.h"
#include "player/commands/commands.h"
#include "player/files/picture_encoder.h"
#include "player/web/html_page.h"
#include "player/web/page_json.h"
#include "player/write_picture.h"

namespace splatlas {
namespace {

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
  const std::string& subject = error.subject;
  if (subject == "camera: zoom") error.message.replace(0, subject.size(), "--zoom");
  if (subject == "camera: field of view") error.message.replace(0, subject.size(), "--field-of-view");
  return error;
}

/// Adds a line that is not there yet.
void add(std::vector<std::string>& lines, const std::string& line) {
  if (std::ranges::find(lines, line) == lines.end()) lines.push_back(line);
}

/// Warns of ghosts that are volumes, and of a rest without structures.
void add_vain_terms(std::span<const SelectionTerm> terms, const Selection& selection,
                    std::vector<std::string>& warnings) {
  const auto rests = std::ranges::count(terms, TermTarget::kRest, &SelectionTerm::target);  // numbered first
  const bool is_empty = std::ranges::none_of(selection.structures, [&](const StructureDraw& draw) {
    return draw.mode != DrawMode::kOff && draw.term < rests;
  });
  for (const SelectionTerm& term : terms) {
    const bool is_rest = is_empty && term.target == TermTarget::kRest;
    if (!is_rest && !(term.ghost && term.mode == DrawMode::kVolume)) continue;
    add(warnings, fmt::format("selection, column {}: {}", term.column + 1,
                              is_rest ? "rest selects nothing: the other terms name every structure"
                                      : "ghost has no effect on a volume; write :surface(ghost)"));
  }
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
  const bool to_stream = request.output == "-";
  if (!to_stream) SPLATLAS_RETURN_IF_ERROR(add_file(request.output, picture, files));
  SPLATLAS_RETURN_IF_ERROR(commit_files(files));
  return to_stream ? print_bytes(picture) : Result<void>();
}

/// Endings of the outputs, and that they can be written and are no inputs.
Result<void> check_files(const RenderRequest& request) {
  std::filesystem::path output = request.output;
  const Result<void> is_picture = PictureEncoder::check_ending(output);
  if (request.is_folder()) {
    if (is_picture || output == "-")
      return fail(ErrorCode::kUsage, "{}: must name a folder, without the ending of a picture",
                  output.string());
    SPLATLAS_RETURN_IF_ERROR(check_writable_folder(std::exchange(output, {})));
  } else if (output != "-") {
    SPLATLAS_RETURN_IF_ERROR(is_picture);
  } else if (output.clear(); ::isatty(STDOUT_FILENO) != 0) {
    return fail(ErrorCode::kUsage, "-o -: standard output is a terminal; redirect it: -o - > picture.png");
  }
  if (!request.ids.empty()) SPLATLAS_RETURN_IF_ERROR(check_id_ending(request.ids));
  if (!request.depth.empty()) SPLATLAS_RETURN_IF_ERROR(check_depth_ending(request.depth));
  const std::vector outputs{output, request.stats, request.ids, request.depth};
  SPLATLAS_RETURN_IF_ERROR(check_outputs(outputs, std::vector{request.atlas, request.page.font}));
  for (const std::filesystem::path& path : outputs)
    if (!path.empty()) SPLATLAS_RETURN_IF_ERROR(check_writable_file(path));
  return {};
}

/// One renderer and one page renderer for all pictures of a command.
struct Drawing {
  const RenderRequest& request;
  std::shared_ptr<const Atlas> atlas;
  PageRenderer pages;
  Renderer renderer;
  Camera camera = {};            // of what is shown
  bool is_fitted = false;        // the camera is; else its zoom is relative to the fit
  std::vector<Rgb> colors = {};  // [structure]; empty: those of the atlas
  RenderReport report = {};

  /// Selects what a scene shows, or else the options. Options that are given replace its values.
  Result<void> show(const Scene* scene) {
    camera = request.camera;
    SceneFraming framing;
    if (scene != nullptr) {
      SPLATLAS_ASSIGN_OR_RETURN(framing, framing_of(*scene, *atlas));
      camera.azimuth_deg = scene->azimuth_deg;
      camera.elevation_deg = scene->elevation_deg;
      camera.zoom *= scene->zoom;
      if (!request.names_projection && scene->perspective) camera.projection = CameraProjection::kPerspective;
      camera.center_lps_mm = framing.center_lps_mm;
      if (!request.page.caption && !request.all_scenes && !scene->caption.empty())
        pages.set_caption(scene->caption);
    }
    if (!request.page.render.cuts.empty()) framing.cuts = request.page.render.cuts;
    const Result<std::optional<Vec3>> center = center_of(request.center, *atlas);
    if (!center) return fail(center.error().code, "{}: --center: {}", atlas->name(), center.error().message);
    if (*center) camera.center_lps_mm = *center;
    pages.set_framing(framing);
    if (request.names_caps && framing.cuts.empty()) add(report.warnings, "--cap has no effect without --cut");
    const auto named = [&](const Error& error) {
      return in_selection(error, *atlas, scene != nullptr ? scene->name : "");
    };
    const std::string& text = scene != nullptr ? scene->selection : request.select;
    SPLATLAS_ASSIGN_OR_RETURN(const auto terms, parse_selection(text).map_error(named));
    SPLATLAS_ASSIGN_OR_RETURN(const Selection selection,
                              resolve_selection(terms, atlas->graph(), colors).map_error(named));
    SPLATLAS_ASSIGN_OR_RETURN(const std::vector<std::string> warnings, selection_warnings(terms, *atlas));
    for (const std::string& line : warnings) add(report.warnings, line);
    add_vain_terms(terms, selection, report.warnings);
    if (const double elevation = camera.elevation_deg; std::abs(elevation) > 90)
      add(report.warnings,
          fmt::format("--elevation {} lies beyond the pole: what is superior points down", elevation));
    return renderer.select(selection);
  }

  Result<void> show_requested() {
    if (request.scene.empty()) return show(nullptr);
    SPLATLAS_ASSIGN_OR_RETURN(const Scene scene, find_scene(request.scene, *atlas));
    return show(&scene);
  }

  Result<Page> render(const Camera& from, const RenderControl& control, std::size_t n = 0,
                      std::size_t count = 1) {
    const auto progress = [&](double fraction) {
      if (control.progress)
        control.progress((static_cast<double>(n) + fraction) / static_cast<double>(count));
    };
    SPLATLAS_ASSIGN_OR_RETURN(
        Page page, pages.render(renderer, from, {control.stop, progress}, is_fitted).map_error(with_option));
    const std::string nothing = emptiness_of(page.frame);
    if (!nothing.empty()) add(report.warnings, nothing);
    for (const MissingPart& part : page.frame.missing) add(report.missing, describe(part, atlas->graph()));
    return page;
  }

  Result<std::vector<std::byte>> encode(Page& page) {
    for (const std::string& note : page.annotations.notes) add(report.notes, note);
    return pages.encode(page);
  }

  /// Shows the whole selection while the camera turns about the middle of its first picture.
  Result<void> fit_turn() {
    constexpr int kSteps = 24;  // of at most 15 degrees: up to 1 % is lost between them, half of a margin
    const PictureSize size = request.page.render.size;
    SPLATLAS_ASSIGN_OR_RETURN(Camera fitted, pages.fit(renderer, camera).map_error(with_option));
    for (int n = 1; n <= kSteps; ++n) {
      Camera turned = camera;
      turned.azimuth_deg += std::clamp(request.turn_deg, -360.0, 360.0) * n / kSteps;
      SPLATLAS_ASSIGN_OR_RETURN(turned, pages.fit(renderer, turned).map_error(with_option));
      // The middle of this picture is aside of the first one's
      const auto middle = std::exchange(turned.center_lps_mm, fitted.center_lps_mm);
      SPLATLAS_ASSIGN_OR_RETURN(const View view, view_of(turned, size, atlas->display()));
      const auto at = view.picture_point(middle.value_or(view.plane.center_lps_mm)).value_or(PicturePoint());
      const double aside =
          std::max(std::abs(2 * at.x / size.width - 1), std::abs(2 * at.y / size.height - 1));
      fitted.zoom = std::min(fitted.zoom, turned.zoom / (1 + aside));
    }
    camera = fitted;
    is_fitted = true;
    return {};
  }
};

/// Writes a picture of every scene and the pages of a handout, or the frames of a turn.
Result<void> write_folder(Drawing& drawing, const RenderControl& control) {
  const bool is_handout = drawing.request.all_scenes;
  const Atlas& atlas = *drawing.atlas;
  const std::size_t count = is_handout ? atlas.scenes().size() : drawing.request.frames;
  if (count == 0)
    return fail(ErrorCode::kFailed, "{}: the atlas has no scenes; add some with splatlas-preprocess lesson",
                atlas.name());
  if (!is_handout) {
    SPLATLAS_RETURN_IF_ERROR(drawing.show_requested());
    SPLATLAS_RETURN_IF_ERROR(drawing.fit_turn());
  }
  SPLATLAS_ASSIGN_OR_RETURN(OutputFolder folder, OutputFolder::create(drawing.request.output));
  const auto add = [&](const std::string& name, std::span<const std::byte> bytes) {
    return folder.add(name, [&](OutputFile& file) { return file.write(bytes); });
  };
  const std::size_t digits = is_handout ? std::max<std::size_t>(2, std::to_string(count).size()) : 4;
  std::vector<HandoutEntry> entries;
  std::vector<std::byte> pdf;
  for (std::size_t n = 0; n < count; ++n) {
    const TaskControl task({}, {}, &atlas.work_budget());
    if (is_handout) SPLATLAS_RETURN_IF_ERROR(drawing.show(&atlas.scenes()[n]));
    Camera camera = drawing.camera;
    camera.azimuth_deg += drawing.request.turn_deg * static_cast<double>(n) / static_cast<double>(count);
    SPLATLAS_ASSIGN_OR_RETURN(Page page, drawing.render(camera, control, n, count));
    const std::string name = fmt::format("{:0{}}.png", n + 1, digits);
    if (is_handout) {
      const Scene& scene = atlas.scenes()[n];
      entries.push_back({{fmt::format("{}. {}", n + 1, scene.name), scene.question, scene.caption}, name});
      SPLATLAS_ASSIGN_OR_RETURN(pdf,
                                drawing.pages.encode_in_document(page, entries.back().texts, n + 1 == count));
    }
    SPLATLAS_ASSIGN_OR_RETURN(const std::vector<std::byte> picture, drawing.encode(page));
    SPLATLAS_RETURN_IF_ERROR(add(name, picture));
  }
  if (is_handout) {
    const std::string html = encode_handout(atlas.provenance().title, entries);
    SPLATLAS_RETURN_IF_ERROR(add("handout.html", std::as_bytes(std::span(html))));
    SPLATLAS_RETURN_IF_ERROR(add("handout.pdf", pdf));
  }
  return folder.commit();
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
  const bool is_png = request.is_folder() || request.output == "-";
  SPLATLAS_ASSIGN_OR_RETURN(PageRenderer pages,
                            PageRenderer::create(is_png ? "picture.png" : request.output, options));

  const auto start = std::chrono::steady_clock::now();
  SPLATLAS_ASSIGN_OR_RETURN(std::shared_ptr<const Atlas> atlas,
                            Atlas::open(request.atlas, request.atlas_options));
  const std::chrono::duration<double, std::milli> open_ms = std::chrono::steady_clock::now() - start;
  Drawing drawing{request, atlas, std::move(pages), Renderer(atlas, request.renderer)};
  if (request.distinct_colors) {
    SPLATLAS_ASSIGN_OR_RETURN(drawing.colors, atlas->distinct_colors());
  }
  if (request.is_folder()) {
    SPLATLAS_RETURN_IF_ERROR(write_folder(drawing, control));
  } else {
    const TaskControl task({}, {}, &atlas->work_budget());  // of all steps together
    SPLATLAS_RETURN_IF_ERROR(drawing.show_requested());
    SPLATLAS_ASSIGN_OR_RETURN(Page page, drawing.render(drawing.camera, control));
    SPLATLAS_ASSIGN_OR_RETURN(const std::vector<std::byte> picture, drawing.encode(page));
    const std::string stats = json_text(stats_json(page.frame, *atlas, open_ms.count()));
    SPLATLAS_RETURN_IF_ERROR(write_outputs(request, picture, stats, page.frame));
  }
  return std::move(drawing.report);
}

}  // namespace splatlas
