// splatlas-preprocess: makes atlases, and takes them apart again.

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "format/interrupts.h"
#include "preprocess/commands/build_command.h"
#include "preprocess/commands/export_command.h"

namespace splatlas {
namespace {

constexpr const char* kTool = "splatlas-preprocess " SPLATLAS_VERSION;

constexpr const char* kDescription =
    "Turns classified medical volumes into compact, playable anatomy atlases.\n"
    "\n"
    "  splatlas-preprocess build -o brain.atlas --labels aal.nii.gz --names aal.nii.txt --volume ch2.nii.gz\n"
    "  splatlas-preprocess export brain.atlas --labels labels.nii.gz\n"
    "\n"
    "COMMAND --help tells everything about a command.";

int run(int argc, char** argv) {
  CLI::App app{kDescription, "splatlas-preprocess"};
  app.set_version_flag("--version", std::string(kTool) + " (atlas format 1)");
  app.get_formatter()->column_width(30);
  app.require_subcommand(1);
  const BuildWordsPtr build = add_build(app);
  ExportWords export_words;
  add_export(app, export_words);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    fmt::print(stderr, "splatlas-preprocess: {}; see --help\n", error.what());
    return exit_status(ErrorCode::kUsage);
  }
  install_interrupt_handlers();
  const Result<void> result =
      app.got_subcommand("build") ? run_build(*build, kTool) : run_export(export_words);
  if (result) return 0;
  fmt::print(stderr, "splatlas-preprocess: {}\n", result.error().message);
  return exit_status(result.error().code);
}

/// A full device is told of when the last line leaves the buffer, not before.
int status_after_output(int status) {
  std::cout.flush();  // CLI11's --help
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout.good()) return status;
  fmt::print(stderr, "splatlas-preprocess: standard output: cannot be written: {}\n", std::strerror(errno));
  return status == 0 ? exit_status(ErrorCode::kFailed) : status;
}

}  // namespace
}  // namespace splatlas

int main(int argc, char** argv) try {
  return splatlas::status_after_output(splatlas::run(argc, argv));
} catch (const std::bad_alloc&) {
  std::fputs("splatlas-preprocess: not enough memory\n", stderr);
  return 1;
} catch (const std::exception& exception) {
  std::fprintf(stderr, "splatlas-preprocess: %s\n", exception.what());
  return 1;
}
