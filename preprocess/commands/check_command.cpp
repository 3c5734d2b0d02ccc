#include <array>

#include <CLI/CLI.hpp>

#include "format/atlas_reader.h"
#include "format/io/output_file.h"
#include "format/program/command_options.h"
#include "format/program/standard_output.h"
#include "format/result_macros.h"
#include "preprocess/check/examine_atlas.h"
#include "preprocess/commands/commands.h"

namespace splatlas {
namespace {

constexpr const char* kCheckHelp =
#include "preprocess/commands/check_help.txt"
    ;

}  // namespace

CLI::App* add_check(CLI::App& app, CheckRequest& request) {
  CLI::App* check = app.add_subcommand("check", "Look for faults in an atlas, and measure its structures");
  check->footer(kCheckHelp);
  check->add_option("ATLAS", request.atlas, "atlas file")->required()->check(names_a_file());
  check->add_option("--report", request.reports.html, "also write structures and findings to FILE.html")
      ->check(names_a_file());
  check->add_option("--json", request.reports.json, "also write them to FILE.json")->check(names_a_file());
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

}  // namespace splatlas
