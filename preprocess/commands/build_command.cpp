#include <algorithm>
#include <cstdio>
#include <optional>
#include <span>

#include <CLI/CLI.hpp>
#include <sys/stat.h>
#include <unistd.h>

#include "format/io/output_file.h"
#include "format/program/command_options.h"
#include "format/program/standard_output.h"
#include "format/result_macros.h"
#include "format/text/ascii_text.h"
#include "preprocess/commands/commands.h"
#include "preprocess/import/tables/text_file.h"

namespace splatlas {
namespace {

/// A text, as a raw string.
constexpr const char* kBuildHelp =
#include "preprocess/commands/build_help.txt"
    ;

std::string check_text(const std::string& text) {
  const std::string fault = fault_of_text(text);
  return fault.empty() ? fault : in_quotes(text) + " " + fault;
}

/// X,Y,Z in mm.
std::optional<Vec3> parse_spacing(std::string_view text) {
  const auto spacing = parse_numbers<3>(text);
  const auto is_length = [](double mm) { return mm >= kMinSpacingMm && mm <= kMaxSpacingMm; };
  return spacing && std::ranges::all_of(*spacing, is_length) ? spacing : std::nullopt;
}

void add_sources(CLI::App& build, SourceFiles& sources) {
  build
      .add_option_function<std::vector<std::string>>(
          "--labels",
          [&sources](const std::vector<std::string>& texts) {
            const LabelsFile first = parse_labels(texts.front());
            sources.labels = first.file;
            sources.labels_group = first.group;
            for (std::size_t n = 1; n < texts.size(); ++n)
              sources.more_labels.push_back(parse_labels(texts[n]));
          },
          "FILE: label map, segmentation, or folder of masks; - for standard input; or NAME=FILE, below a "
          "group (repeatable)")
      ->allow_extra_args(false)
      ->check(names_a_file());
  build.add_flag("--as-labels", sources.as_labels,
                 "round the values of a label map, even if they look like grey values");
  add_path(build, "--volume", sources.volume, "grey values");
  build
      .add_option("--component", sources.volume_options.component,
                  "volume of a --volume file that holds several, from 1")
      ->check(CLI::Range(std::size_t{1}, std::size_t{1} << 24).description(""))
      ->needs("--volume");
  build
      .add_option("--series", sources.volume_options.series,
                  "series of a --volume folder that holds several: number or UID")
      ->needs("--volume");
  add_choice(build, "--resample", sources.resample,
             {{"labels", ResampleTo::kLabels}, {"volume", ResampleTo::kVolume}},
             "the grid that stays where labels and volume have different ones")
      ->needs("--labels")
      ->needs("--volume");
  add_parsed(build, "--spacing", sources.spacing_mm, parse_spacing,
             "must be X,Y,Z, three lengths in mm above 0",
             "X,Y,Z in mm: size of the voxels of TIFF and PNG pictures");
  add_path(build, "--names", sources.names, "names of the labels, or of surfaces");
  Choices<NamesFormat> formats{{"auto", NamesFormat::kAuto}};
  for (const NamesFormatInfo& info : names_formats()) formats.emplace_back(info.option, info.format);
  add_choice(build, "--names-format", sources.names_format, formats, "dialect of --names")->needs("--names");
  add_path(build, "--tree", sources.tree, "hierarchy of the structures");
  add_path(build, "--sides", sources.sides, "FILE or x=MM: split the labels that lie on both sides")
      ->needs("--labels");
  add_repeated(build, "--segment", sources.segments, parse_segment,
               "NAME=RULE: a structure from thresholds or a mask (repeatable)");
  add_repeated(
      build, "--mesh", sources.meshes, parse_mesh,
      "NAME=FILE[,frame=ras|lps][,transform=FILE][,scale=S][,color=#rrggbb]: an external surface; or "
      "FOLDER[,...]: all in it (repeatable)");
  build.add_flag("--fit-grid", sources.fit_grid, "widen the grid for surfaces that reach beyond it");
  build.add_flag("--allow-empty", sources.allow_empty,
                 "keep named labels without voxels, as empty structures");
}

/// Copies standard input to a file of `folder`, whose ending says what it holds. It goes with the folder.
Result<std::filesystem::path> take_standard_input(std::optional<OutputFolder>& folder) {
  if (::isatty(STDIN_FILENO) != 0)
    return fail(ErrorCode::kUsage, "--labels -: standard input is a terminal; redirect it: < labels.nrrd");
  std::vector<char> piece(std::size_t{1} << 20);
  std::size_t count = std::fread(piece.data(), 1, piece.size(), stdin);
  const std::string_view start(piece.data(), count);
  const std::string name = start.starts_with("NRRD")       ? "standard input.nrrd"
                           : start.starts_with("\x1f\x8b") ? "standard input.nii.gz"
                                                           : "standard input.nii";
  const mode_t others = ::umask(0077);  // a folder of this user alone
  Result<OutputFolder> created =
      OutputFolder::create(std::filesystem::temp_directory_path() / fmt::format("splatlas-{}", ::getpid()));
  ::umask(others);
  SPLATLAS_ASSIGN_OR_RETURN(folder, std::move(created));
  std::filesystem::path path;
  SPLATLAS_RETURN_IF_ERROR(folder->add(name, [&](OutputFile& file) -> Result<void> {
    path = file.temporary();
    for (; count > 0; count = std::fread(piece.data(), 1, piece.size(), stdin))
      SPLATLAS_RETURN_IF_ERROR(file.write(std::as_bytes(std::span(piece).first(count))));
    return {};
  }));
  if (std::ferror(stdin) != 0) return fail(ErrorCode::kFailed, "standard input: cannot be read");
  return path;
}

}  // namespace

CLI::App* add_build(CLI::App& app, BuildRequest& request) {
  BuildOptions& options = request.options;
  CLI::App* build =
      app.add_subcommand("build", "Make an atlas from volumes, labels, names, trees and surfaces");
  build->footer(kBuildHelp);
  add_path(*build, "-o,--output", options.output, "atlas file to write")->required();
  add_sources(*build, options.sources);
  add_path(*build, "--scene", options.sources.scenes,
           "TOML file with named views for a lesson (repeatable; see Scenes)")
      ->expected(1)
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  build->add_option("--title", options.title, "stored in the atlas")->check(check_text);
  build->add_option("--citation", options.citation, "stored in the atlas")->check(check_text);
  build->add_option("--licence,--license", options.licence, "stored in the atlas")->check(check_text);
  add_repeated(*build, "--drop-fragments", options.fragments, parse_fragments,
               "[NAME=]N: drop components of fewer than N voxels beside the largest one (repeatable)");
  build->add_flag("--strict", options.strict, "stop at the first warning, and write nothing");
  add_path(*build, "--report", request.reports.html,
           "also write all notes, findings and structures to FILE.html");
  add_path(*build, "--json", request.reports.json, "the same to FILE.json");
  build->add_flag("--compact", options.compact, "leave out data that a player derives in milliseconds");
  add_surfaces(
      *build, options.surfaces,
      "surfaces of structures; smooth ones stay within about half a voxel of the labels' border, along "
      "its longest side");
  build->add_option("--level", options.level, "Zstandard level, 1 (fast) to 22 (small)")
      ->check(CLI::Range(1, 22).description(""))
      ->capture_default_str();
  add_threads(*build, options.threads, "0: one per core");
  add_choice(*build, "--progress", request.progress,
             {{"auto", request.progress}, {"none", ProgressMode::kNone}, {"json", ProgressMode::kJson}},
             "progress on standard error");
  return build;
}

Result<void> run_build(const BuildRequest& request) {
  BuildOptions options = request.options;
  std::optional<OutputFolder> input;
  if (options.sources.labels == "-") {
    SPLATLAS_ASSIGN_OR_RETURN(options.sources.labels, take_standard_input(input));
  }
  ProgressDisplay display(request.progress, stderr);
  options.progress = [&](const BuildProgress& progress) { display.show(progress); };
  std::vector<std::filesystem::path> outputs = request.reports.files();
  outputs.insert(outputs.begin(), options.output);
  SPLATLAS_RETURN_IF_ERROR(check_outputs(outputs, list_files(options.sources)));
  for (const std::filesystem::path& file : outputs) SPLATLAS_RETURN_IF_ERROR(check_writable_file(file));
  Notes notes;
  const auto add_reports = [&](const Atlas& atlas, std::vector<OutputFile>& files) -> Result<void> {
    if (request.reports.files().empty()) return {};
    SPLATLAS_ASSIGN_OR_RETURN(const Examination examination, examine_atlas(atlas));
    return request.reports.add(&notes, examination, options.output, files);
  };
  const Result<BuildReport> report = build_atlas(options, notes, add_reports);
  display.finish();
  const std::string error = report ? std::string() : report.error().message;
  if (request.progress != ProgressMode::kJson) {
    for (const Note& note : notes.all()) {
      if (note.level() == NoteLevel::kMinor || error.find(note.message()) != std::string::npos)
        continue;  // --strict
      print_to(stderr, PrintableText("{}: {}\n", note.level() == NoteLevel::kWarning ? "warning" : "note",
                                     note.message()));
    }
  }
  if (!report) return tl::unexpected(report.error());
  double seconds = 0;
  for (const auto& stage : report->stages) seconds += stage.seconds;
  return print_text(PrintableText(
      "{}: {} structure{}, {} classes, {} + {} + {} runs, {} triangles, {} bytes, {:.2f} s\n", options.output,
      report->structures, report->structures == 1 ? "" : "s", report->classes, report->runs[0],
      report->runs[1], report->runs[2], report->triangles, report->bytes, seconds));
}

}  // namespace splatlas
