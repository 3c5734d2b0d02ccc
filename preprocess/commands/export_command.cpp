#include <CLI/CLI.hpp>
#include <sys/resource.h>

#include "format/program/command_options.h"
#include "format/program/standard_output.h"
#include "format/result_macros.h"
#include "preprocess/commands/commands.h"

namespace splatlas {
namespace {

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

}  // namespace

CLI::App* add_export(CLI::App& app, ExportOptions& options) {
  CLI::App* command =
      app.add_subcommand("export", "Write the labels, volume, surfaces, names or tree of an atlas");
  command->footer(kExportExamples);
  command->add_option("ATLAS", options.atlas, "atlas file")->required()->check(names_a_file());
  command->add_option("--labels", options.labels, "label map to write; FOLDER/ for one mask per structure")
      ->check(names_a_file());
  command->add_option("--volume", options.volume, "grey values to write")->check(names_a_file());
  add_repeated(*command, "--surface", options.surfaces, parse_surface,
               "STRUCTURE=FILE: a surface to write (repeatable)");
  command->add_option("--names", options.names, "names, colours and codes to write, as CSV")
      ->check(names_a_file());
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
  command->add_option("--tree", options.tree, "hierarchy to write, as paths")->check(names_a_file());
  add_surfaces(*command, options.atlas_options.surfaces,
               "surfaces that follow from the voxels; as in the atlas if not given");
  add_max_work(*command, options.atlas_options.max_work);
  return command;
}

Result<void> run_export(const ExportOptions& options) {
  rlimit open_files{};  // all outputs are open until they are named
  ::getrlimit(RLIMIT_NOFILE, &open_files);
  open_files.rlim_cur = open_files.rlim_max;
  ::setrlimit(RLIMIT_NOFILE, &open_files);
  SPLATLAS_ASSIGN_OR_RETURN(const ExportedFiles files, export_atlas(options));
  for (const std::string& line : files.written)
    SPLATLAS_RETURN_IF_ERROR(print_text(PrintableText("{}\n", line)));
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

}  // namespace splatlas
