// Program splatlas-player: player and command-line renderer of atlases.

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <unistd.h>

#include "format/io/output_file.h"
#include "format/program/command_options.h"
#include "format/program/standard_output.h"
#include "format/result_macros.h"
#include "format/text/ascii_text.h"
#include "format/text/printable_text.h"
#include "player/commands/commands.h"
#include "player/render/simd/simd_choice.h"
#include "player/web/page_json.h"

namespace splatlas {
namespace {

constexpr const char* kDescription =
#include "player/commands/description.txt"
    ;

constexpr const char* kVersion = "splatlas-player " SPLATLAS_VERSION " (atlas format 1)";

tl::unexpected<Error> wrong_usage(const CLI::App& app, const std::string& what) {
  std::string program = "splatlas-player";
  for (const CLI::App* command : app.get_subcommands()) program += " " + command->get_name();
  return fail(ErrorCode::kUsage, "{}; see {} --help", what, program);
}

tl::unexpected<Error> no_command_or_atlas(const CLI::App& app, const std::filesystem::path& word) {
  return wrong_usage(app, fmt::format("{} is no command (render, export, info, verify) and no atlas file",
                                      in_quotes(word.string())));
}

/// Text with grid, sizes and the tree of structures.
PrintableText info_text(const Atlas& atlas) {
  PrintableText text;
  const Grid& grid = atlas.source_grid();
  text.add("{}: atlas {}, {} bytes\n", atlas.name(), atlas.format_version(), atlas.counters().file);
  if (!atlas.provenance().title.empty()) text.add("title     {}\n", atlas.provenance().title);
  text.add("grid      {} x {} x {} voxels of {:g} x {:g} x {:g} mm, values {}\n", grid.size[0], grid.size[1],
           grid.size[2], grid.spacing_mm[0], grid.spacing_mm[1], grid.spacing_mm[2],
           name_of(atlas.value_type()));
  const auto [low, high] =
      box_lps_mm(grid, {0, 0, 0}, {grid.size[0] - 1, grid.size[1] - 1, grid.size[2] - 1});
  text.add(
      "extent    left {0:.1f} to {3:.1f} (right {6:.1f} to {9:.1f}), posterior {1:.1f} to {4:.1f} (anterior "
      "{7:.1f} to {10:.1f}), superior {2:.1f} to {5:.1f} (inferior {8:.1f} to {11:.1f}) mm\n",
      low[0], low[1], low[2], high[0], high[1], high[2], -high[0], -high[1], -high[2], -low[0], -low[1],
      -low[2]);
  text.add("classes   {}\nruns      x {}, y {}, z {}\nsections ", atlas.classes().size(),
           atlas.runs(Axis::kX), atlas.runs(Axis::kY), atlas.runs(Axis::kZ));
  for (const char* separator = ""; const SectionSize& section : atlas.sections())
    text.add("{} {} {}", std::exchange(separator, ","), section.name, section.bytes);
  if (!atlas.scenes().empty()) text.add("\nscenes   ");
  for (const char* separator = ""; const Scene& scene : atlas.scenes())
    text.add("{} {}", std::exchange(separator, ","), in_quotes(scene.name));
  text.add("\n\n{:<50} {:>10} {:>10} {:>10}\n", "structure (again under every parent)", "interior",
           "boundary", "triangles");
  // Depth first; a structure appears under each of its parents.
  constexpr std::size_t kMaxLines = 10000;
  const std::vector<SubtreeCounts> counts = counts_of(atlas);
  std::size_t lines = 0;
  const auto add = [&](const auto& add_below, StructureIndex s, std::size_t depth) -> void {
    if (++lines > kMaxLines) return;
    text.add("{:<50} {:>10} {:>10} {:>10}", std::string(2 * depth, ' ') + atlas.graph()[s].name,
             counts[s].interior, counts[s].boundary, counts[s].triangles);
    for (const Term& term : atlas.graph()[s].terms) text.add("  {} {}", term.vocabulary, term.value);
    text.add("\n");
    for (const StructureIndex child : atlas.graph().children(s)) add_below(add_below, child, depth + 1);
  };
  for (const StructureIndex root : atlas.graph().roots()) add(add, root, 0);
  if (lines > kMaxLines) text.add("... (more than {} lines; --json lists every structure once)\n", kMaxLines);
  return text;
}

Result<void> print_info(const std::filesystem::path& path, bool json) {
  SPLATLAS_ASSIGN_OR_RETURN(const auto atlas, Atlas::open(path));
  return print_text(json ? PrintableText::of_layout(info_json(*atlas)) : info_text(*atlas));
}

Result<void> verify_file(const std::filesystem::path& path, const AtlasOptions& options) {
  SPLATLAS_ASSIGN_OR_RETURN(const auto atlas, Atlas::open(path, options));
  SPLATLAS_RETURN_IF_ERROR(atlas->verify());
  return print_text(PrintableText("{}: a valid atlas, {} bytes, every checksum and every number checked\n",
                                  path, atlas->counters().file));
}

/// Progress of a picture that takes long, in one line on a terminal.
class RenderProgress {
 public:
  void show(double fraction) {
    constexpr std::chrono::milliseconds kLong{1000}, kPause{100};
    const auto now = Clock::now();
    if (!is_terminal_ || now - start_ < kLong || now - shown_ < kPause) return;
    shown_ = now;
    print_to(stderr, PrintableText("\r{:3.0f} % rendered\x1b[K", 100 * fraction));
  }
  /// Removes the line, so that a message can follow.
  ~RenderProgress() {
    if (shown_ != Clock::time_point{}) print_to(stderr, PrintableText("\r\x1b[K"));
  }
  RenderProgress() = default;
  RenderProgress(const RenderProgress&) = delete;
  RenderProgress& operator=(const RenderProgress&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  const bool is_terminal_ = ::isatty(STDERR_FILENO) != 0;
  const Clock::time_point start_ = Clock::now();
  Clock::time_point shown_{};
};

/// Renders a picture. A damaged atlas gives a picture of its intact parts and an error for scripts.
Result<void> render_picture(const RenderRequest& request) {
  const auto rendered = [&] {
    RenderProgress progress;
    return run_render(request, {.progress = [&](double fraction) { progress.show(fraction); }});
  }();
  SPLATLAS_ASSIGN_OR_RETURN(const RenderReport report, rendered);
  for (const std::string& line : report.warnings) print_to(stderr, PrintableText("warning: {}\n", line));
  for (const std::string& note : report.notes) print_to(stderr, PrintableText("note: {}\n", note));
  if (report.missing.empty()) return {};
  for (const std::string& line : report.missing) print_error("splatlas-player", line);
  return fail(ErrorCode::kInvalidAtlas, "{}: damaged; {} was written without what is missing",
              request.atlas.string(), request.output.string());
}

/// Options and commands, bound to typed variables.
struct CommandLine {
  CLI::App app{kDescription, "splatlas-player"};
  PlayRequest play_request;
  std::filesystem::path atlas;  // argument of info and verify
  AtlasOptions atlas_options;   // of verify
  bool json = false;
  RenderRequest request;
  ExportRequest export_request;
  CLI::App* render = nullptr;
  CLI::App* export_page = nullptr;
  CLI::App* info = nullptr;
  CLI::App* verify = nullptr;

  CommandLine() {
    app.set_version_flag("--version", kVersion);
    app.get_formatter()->column_width(28);
    add_play(app, play_request);
    render = add_render(app, request);
    export_page = add_export(app, export_request);
    info = app.add_subcommand("info", "List grid, structures, counts and sizes");
    add_path(*info, "ATLAS", atlas, "atlas file")->required();
    info->add_flag("--json", json, "as a JSON document");
    verify = app.add_subcommand("verify", "Check every byte of an atlas; stops at the first fault");
    add_path(*verify, "ATLAS", atlas, "atlas file")->required();
    add_max_work(*verify, atlas_options.max_work);
    verify->footer(
        "Example:\n  splatlas-player verify brain.atlas\n\nExit status: 0 for an intact file, 3 for a "
        "damaged one.");
    app.require_subcommand(0, 1);
  }
};

/// Refuses words and options in front of a command: they are those of the page.
Result<void> check_order(const CommandLine& line) {
  if (line.app.get_subcommands().empty()) return {};
  const std::string& command = line.app.get_subcommands().front()->get_name();
  for (const CLI::Option* option : line.app.get_options()) {
    if (option->count() == 0) continue;
    const std::string& text = option->get_positional() ? option->results().front() : option->get_name();
    return wrong_usage(
        line.app, fmt::format("{} in front of {}: write it behind the command", in_quotes(text), command));
  }
  return {};
}

Result<void> run_command(const CommandLine& line) {
  if (line.render->parsed()) {
    install_interrupt_handlers();
    return render_picture(line.request);
  }
  if (line.export_page->parsed()) {
    install_interrupt_handlers();
    return run_export(line.export_request);
  }
  if (line.info->parsed()) return print_info(line.atlas, line.json);
  if (line.verify->parsed()) return verify_file(line.atlas, line.atlas_options);
  const std::filesystem::path& atlas = line.play_request.atlas;
  if (atlas.empty()) return wrong_usage(line.app, "no atlas file is given");
  // A lone word is more likely a misspelt command than a missing file.
  std::error_code ignored;
  const bool is_word = !atlas.has_parent_path() && !atlas.has_extension();
  if (is_word && !std::filesystem::exists(atlas, ignored)) return no_command_or_atlas(line.app, atlas);
  return play(line.play_request);
}

/// The file that the command reads.
const std::filesystem::path& file_of(const CommandLine& line) {
  if (line.render->parsed()) return line.request.atlas;
  if (line.export_page->parsed()) return line.export_request.atlases.front();
  return line.atlas.empty() ? line.play_request.atlas : line.atlas;
}

Result<void> run(int argc, char** argv) {
  CommandLine line;
  try {
    line.app.parse(argc, argv);
  } catch (const CLI::Success& help_or_version) {
    std::ostringstream text;
    line.app.exit(help_or_version, text);
    return print_text(PrintableText::of_layout(text.str()));
  } catch (const CLI::ExtrasError& error) {
    std::error_code ignored;
    const bool has_command = !line.app.get_subcommands().empty();
    const std::filesystem::path& atlas = line.play_request.atlas;
    if (has_command || atlas.empty() || std::filesystem::exists(atlas, ignored)) {
      return wrong_usage(line.app, fault_of_usage(line.app, error));
    }
    return no_command_or_atlas(line.app, atlas);
  } catch (const CLI::ValidationError& error) {
    return fail(ErrorCode::kUsage, error.what());
  } catch (const CLI::ParseError& error) {
    return wrong_usage(line.app, error.what());
  }
  SPLATLAS_RETURN_IF_ERROR(check_order(line));
  if (!simd_is_available())
    return fail(
        ErrorCode::kUsage,
        "SPLATLAS_SIMD={} in the environment: must be scalar, sse4, avx2 or avx512, and one of the machine's",
        forced_simd());
  SPLATLAS_RETURN_IF_ERROR(
      run_on_file(file_of(line), "take a smaller --size or select less", [&] { return run_command(line); }));
  return finish_standard_output();
}

}  // namespace
}  // namespace splatlas

int main(int argc, char** argv) {
  return splatlas::run_main("splatlas-player", [&] { return splatlas::run(argc, argv); });
}
