// splatlas-player: plays atlases, in a window or headless.

#include <cstdio>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "player/commands/info_command.h"
#include "player/commands/render_command.h"
#ifdef SPLATLAS_HAS_WINDOW
#include "player/window/player_window.h"
#endif

namespace splatlas {
namespace {

constexpr const char* kDescription =
    "Plays anatomy atlases: any selection of structures, each as surface, volume or both.\n"
    "\n"
    "  splatlas-player brain.atlas                 opens a window\n"
    "  splatlas-player render brain.atlas -o picture.png --select 'Cerebellum:surface'\n"
    "  splatlas-player info brain.atlas            lists structures and sizes";

constexpr const char* kRenderFooter =
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

constexpr const char* kVersion = "splatlas-player " SPLATLAS_VERSION " (atlas format 1)";

int report(const Error& error) {
  fmt::print(stderr, "splatlas-player: {}\n", error.message);
  return exit_status(error.code);
}

/// What CLI11 collects as text and we check ourselves, so that every message says what to do.
struct RenderWords {
  std::string size = "512x512", quality = "normal", projection = "parallel", view, background = "#000000";
  std::string shading = "hybrid";
  double azimuth = 0, elevation = 0;
};

Result<PictureSize> parse_size(const std::string& text) {
  PictureSize size;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%9dx%9d%c", &size.width, &size.height, &rest) != 2) {
    return fail(ErrorCode::kUsage,
                fmt::format("--size {}: must be WIDTHxHEIGHT in pixels, as in 1024x768", text));
  }
  return size;
}

Result<void> apply_words(const RenderWords& words, const CLI::App& command, RenderRequest& request) {
  SPLATLAS_ASSIGN_OR_RETURN(request.options.size, parse_size(words.size));
  const auto quality = named_quality(words.quality);
  if (!quality)
    return fail(ErrorCode::kUsage, fmt::format("--quality {}: must be draft, normal or high", words.quality));
  request.options.quality = *quality;
  if (words.projection != "parallel") {
    return fail(
        ErrorCode::kUsage,
        fmt::format("--projection {}: this version renders in parallel projection only", words.projection));
  }
  if (words.shading != "hybrid" && words.shading != "none") {
    return fail(ErrorCode::kUsage, fmt::format("--shading {}: must be hybrid or none", words.shading));
  }
  request.options.hybrid_shading = words.shading == "hybrid";
  if (!words.view.empty()) {
    const auto view = named_view(words.view);
    if (!view) {
      return fail(ErrorCode::kUsage,
                  fmt::format("--view {}: must be anterior, posterior, left, right, superior or inferior",
                              words.view));
    }
    const double zoom = request.camera.zoom;
    request.camera = Camera::of(*view);
    request.camera.zoom = zoom;
  }
  if (command.count("--azimuth") > 0) request.camera.azimuth_deg = words.azimuth;
  if (command.count("--elevation") > 0) request.camera.elevation_deg = words.elevation;
  if (words.background == "transparent") {
    request.background.reset();
  } else {
    SPLATLAS_ASSIGN_OR_RETURN(request.background, parse_color(words.background));
  }
  return {};
}

void add_render(CLI::App& app, RenderRequest& request, RenderWords& words) {
  CLI::App* command = app.add_subcommand("render", "Render a selection to a picture file, without a window");
  command->add_option("ATLAS", request.atlas, "atlas file")->required();
  command->add_option("-o,--output", request.output, "picture: .png, .jpg, .tif, or .exr (linear float RGBA)")
      ->required();
  command->add_option("--select", request.select, "selection text (see below)")->capture_default_str();
  command->add_option("--size", words.size, "WIDTHxHEIGHT in pixels")->capture_default_str();
  command->add_option("--view", words.view, "anterior, posterior, left, right, superior or inferior");
  command->add_option("--azimuth", words.azimuth,
                      "degrees around the superior axis: 0 anterior, 90 the subject's left");
  command->add_option("--elevation", words.elevation, "degrees above the horizon");
  command->add_option("--zoom", request.camera.zoom, "1 fits the atlas into the picture")
      ->capture_default_str();
  command->add_option("--projection", words.projection, "parallel")->capture_default_str();
  command->add_option("--quality", words.quality, "draft, normal or high")->capture_default_str();
  command->add_option("--shading", words.shading, "hybrid: boundary voxels are lit by their normals; none")
      ->capture_default_str();
  command->add_option("--background", words.background, "#rrggbb or transparent")->capture_default_str();
  command->add_option("--threads", request.threads, "0: one per core; the picture does not depend on it")
      ->capture_default_str();
  command->add_option("--stats", request.stats, "write what was visited and read, and times, to a JSON file");
  command->footer(kRenderFooter);
}

Result<void> print_info(const std::filesystem::path& path, bool json) {
  SPLATLAS_ASSIGN_OR_RETURN(const auto atlas, Atlas::open(path));
  const std::string text = json ? info_json(*atlas) : info_text(*atlas);
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
    return fail(ErrorCode::kFailed, "cannot write to standard output");
  }
  return {};
}

Result<void> verify_file(const std::filesystem::path& path) {
  SPLATLAS_ASSIGN_OR_RETURN(const auto atlas, Atlas::open(path));
  SPLATLAS_RETURN_IF_ERROR(atlas->verify());
  fmt::print("{}: a valid atlas, {} bytes, every checksum and every number checked\n", path.string(),
             atlas->counters().file);
  return {};
}

Result<void> open_window(const std::filesystem::path& path, [[maybe_unused]] unsigned threads) {
#ifdef SPLATLAS_HAS_WINDOW
  return run_window(path, threads);
#else
  return fail(ErrorCode::kUsage,
              fmt::format("{}: this player was built without a window; use 'render'", path.string()));
#endif
}

int run(int argc, char** argv) {
  CLI::App app{kDescription, "splatlas-player"};
  app.set_version_flag("--version", kVersion);
  app.get_formatter()->column_width(28);
  std::filesystem::path atlas;
  unsigned window_threads = 0;
  app.add_option("ATLAS", atlas, "atlas file to open in a window");
  app.add_option("--threads", window_threads, "0: one per core")->capture_default_str();
  RenderRequest request;
  RenderWords words;
  add_render(app, request, words);
  CLI::App* info = app.add_subcommand("info", "List grid, structures, counts and sizes");
  bool json = false;
  info->add_option("ATLAS", atlas, "atlas file")->required();
  info->add_flag("--json", json, "as a JSON document");
  CLI::App* verify = app.add_subcommand("verify", "Check every byte of an atlas");
  verify->add_option("ATLAS", atlas, "atlas file")->required();
  app.require_subcommand(0, 1);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : exit_status(ErrorCode::kUsage);
  }

  Result<void> result;
  if (const CLI::App* render = app.get_subcommand("render"); render->parsed()) {
    result = apply_words(words, *render, request);
    if (result) result = run_render(request);
  } else if (info->parsed()) {
    result = print_info(atlas, json);
  } else if (verify->parsed()) {
    result = verify_file(atlas);
  } else if (!atlas.empty()) {
    result = open_window(atlas, window_threads);
  } else {
    fmt::print("{}", app.help());
    return exit_status(ErrorCode::kUsage);
  }
  return result ? 0 : report(result.error());
}

}  // namespace
}  // namespace splatlas

int main(int argc, char** argv) try {
  return splatlas::run(argc, argv);
} catch (const std::exception& exception) {
  fmt::print(stderr, "splatlas-player: {}\n", exception.what());
  return 1;
}
