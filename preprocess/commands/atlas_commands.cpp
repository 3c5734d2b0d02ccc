// Commands that read an atlas: check, export and lesson.
#include <array>

#include <CLI/CLI.hpp>
#include <sys/resource.h>
#include <unistd.h>

#include "format/atlas_reader.h"
#include "format/io/output_file.h"
#include "format/program/command_options.h"
#include "format/program/standard_output.h"
#include "format/result_macros.h"
#include "preprocess/check/examine_atlas.h"
#include "preprocess/commands/commands.h"
#include "preprocess/import/tables/read_scenes.h"

namespace splatlas {
namespace {

constexpr const char* kCheckHelp =
#include "preprocess/commands/check_help.txt"
    ;

constexpr const char* kExportExamples =
#include "preprocess/commands/export_help.txt"
    ;

/// Splits NAME=FILE at the first "="; kUsage if a side is empty.
Result<std::pair<std::string, std::filesystem::path>> parse_surface(std::string_view text) {
  const std::size_t equals = text.find('=');
  const std::string_view name = trimmed(text.substr(0, equals));
  if (equals == std::string_view::npos || name.empty() || equals + 1 == text.size())
    return fail(ErrorCode::kUsage, "--surface '{}': must be NAME=FILE", text);
  return std::pair(std::string(name), std::filesystem::path(text.substr(equals + 1)));
}

constexpr const char* kLessonExamples =
#include "preprocess/commands/lesson_help.txt"
    ;

}  // namespace

CLI::App* add_check(CLI::App& app, CheckRequest& request) {
  CLI::App* check = app.add_subcommand("check", "Look for faults in an atlas, and measure its structures");
  check->footer(kCheckHelp);
  add_path(*check, "ATLAS", request.atlas, "atlas file")->required();
  add_path(*check, "--report", request.reports.html, "also write structures and findings to FILE.html");
  add_path(*check, "--json", request.reports.json, "also write them to FILE.json");
  return check;
}

Result<void> run_check(const CheckRequest& request) {
  const std::vector<std::filesystem::path> outputs = request.reports.files();
  SPLATLAS_RETURN_IF_ERROR(check_outputs(outputs, std::array{request.atlas}));
  for (const std::filesystem::path& file : outputs) SPLATLAS_RETURN_IF_ERROR(check_writable_file(file));
  SPLATLAS_ASSIGN_OR_RETURN(const auto atlas, Atlas::open(request.atlas));
  SPLATLAS_ASSIGN_OR_RETURN(const Examination examination, examine_atlas(*atlas));
  std::vector<OutputFile> files;
  SPLATLAS_RETURN_IF_ERROR(request.reports.add(nullptr, examination, request.atlas, files));
  SPLATLAS_RETURN_IF_ERROR(commit_files(files));
  PrintableText text("{}: {} structure{}, {} finding{}\n", request.atlas, examination.rows.size(),
                     examination.rows.size() == 1 ? "" : "s", examination.findings.size(),
                     examination.findings.size() == 1 ? "" : "s");
  for (const Finding& finding : examination.findings) {
    text.add("{}: {}{}\n", finding.kind, finding.message,
             finding.place_lps_mm ? " (at " + text_of_place(*finding.place_lps_mm) + " mm)" : "");
  }
  return print_text(text);
}

CLI::App* add_export(CLI::App& app, ExportOptions& options) {
  CLI::App* command =
      app.add_subcommand("export", "Write the labels, volume, surfaces, names or tree of an atlas");
  command->footer(kExportExamples);
  add_path(*command, "ATLAS", options.atlas, "atlas file")->required();
  add_path(*command, "--labels", options.labels,
           "label map to write; FOLDER/ for one mask per structure; - for NRRD to standard output");
  add_path(*command, "--volume", options.volume, "grey values to write");
  add_repeated(*command, "--surface", options.surfaces, parse_surface,
               "STRUCTURE=FILE: a surface to write (repeatable)");
  add_path(*command, "--names", options.names, "names, colours and codes to write, as CSV");
  add_choice(*command, "--names-format", options.names_format,
             {{"csv", NamesFormat::kCsv},
              {"itksnap", NamesFormat::kItkSnap},
              {"ctbl", NamesFormat::kCtbl},
              {"freesurfer", NamesFormat::kFreeSurfer},
              {"bids", NamesFormat::kBids},
              {"mricron", NamesFormat::kMricron},
              {"niivue", NamesFormat::kNiivue}},
             "table of --names")
      ->needs("--names");
  add_path(*command, "--tree", options.tree, "hierarchy to write, as paths");
  add_surfaces(*command, options.atlas_options.surfaces);
  add_max_work(*command, options.atlas_options.max_work);
  return command;
}

Result<void> run_export(const ExportOptions& options) {
  if (options.streams_labels() && ::isatty(STDOUT_FILENO) != 0)
    return fail(ErrorCode::kUsage, "--labels -: standard output is a terminal; redirect it: > labels.nrrd");
  rlimit open_files{};  // all outputs are open until they are named
  ::getrlimit(RLIMIT_NOFILE, &open_files);
  open_files.rlim_cur = open_files.rlim_max;
  ::setrlimit(RLIMIT_NOFILE, &open_files);
  SPLATLAS_ASSIGN_OR_RETURN(const ExportedFiles files, export_atlas(options));
  if (options.streams_labels()) {
    SPLATLAS_RETURN_IF_ERROR(print_bytes(files.stream));
  } else {
    for (const std::string& line : files.written)
      SPLATLAS_RETURN_IF_ERROR(print_text(PrintableText("{}\n", line)));
  }
  for (const std::string& note : files.notes) print_to(stderr, PrintableText("note: {}\n", note));
  if (files.failures.empty()) return {};
  Error error = files.failures.front();
  if (const std::size_t count = files.damaged.size(); count > 0) {
    for (std::size_t n = 0; n < count; ++n)
      error.message += (n == 0 ? "; " : n + 1 < count ? ", " : " and ") + files.damaged[n];
    error.message += count == 1 ? " is not written" : " are not written";
  }
  return tl::unexpected(std::move(error));
}

CLI::App* add_lesson(CLI::App& app, LessonRequest& request) {
  CLI::App* lesson = app.add_subcommand("lesson", "Copy an atlas with other scenes; needs no sources");
  lesson->footer(kLessonExamples);
  add_path(*lesson, "ATLAS", request.atlas, "atlas file; stays as it is")->required();
  add_path(*lesson, "--scene", request.scenes,
           "TOML files with the scenes, in place of all scenes of the atlas (repeatable)")
      ->required();
  add_path(*lesson, "-o,--output", request.output, "atlas file to write")->required();
  return lesson;
}

Result<void> run_lesson(const LessonRequest& request) {
  std::vector<std::filesystem::path> inputs = request.scenes;
  inputs.push_back(request.atlas);
  SPLATLAS_RETURN_IF_ERROR(check_outputs(std::array{request.output}, inputs));
  SPLATLAS_RETURN_IF_ERROR(check_writable_file(request.output));
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<SceneFile> files, read_scenes(request.scenes));
  SPLATLAS_ASSIGN_OR_RETURN(const auto atlas, Atlas::open(request.atlas));
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<Scene> scenes, scenes_of(files, atlas->graph()));
  SPLATLAS_ASSIGN_OR_RETURN(OutputFile file, OutputFile::create(request.output));
  SPLATLAS_RETURN_IF_ERROR(
      atlas->copy_with_scenes(scenes, [&](std::span<const std::byte> bytes) { return file.write(bytes); }));
  SPLATLAS_RETURN_IF_ERROR(commit_files(std::span(&file, 1)));
  return print_text(
      PrintableText("{}: {} scene{}\n", request.output, scenes.size(), scenes.size() == 1 ? "" : "s"));
}

}  // namespace splatlas
