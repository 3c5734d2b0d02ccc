// splatlas-phantom FOLDER: source files of the golden phantom, for the demo and command-line tests.
#include <cstdio>
#include <string>

#include "format/program/standard_output.h"
#include "tests/phantom/phantom_files.h"

namespace {

constexpr const char* kHelp =
    "usage: splatlas-phantom FOLDER\n"
    "Writes the golden phantom to FOLDER: labels.nrrd, volume.nrrd, names.txt and phantom.tree.\n";

int report(const splatlas::Error& error) {
  std::fprintf(stderr, "splatlas-phantom: %s\n", error.message.c_str());
  return splatlas::exit_status(error.code);
}

}  // namespace

int main(int argc, char** argv) {
  using splatlas::ErrorCode;
  const std::string word = argc > 1 ? argv[1] : "";
  if (word == "--help" || word == "-h") {
    const bool shown = std::fputs(kHelp, stdout) >= 0 && std::fflush(stdout) == 0;
    return shown ? 0 : report({ErrorCode::kFailed, "standard output: cannot be written"});
  }
  if (argc != 2 || word.empty()) return report({ErrorCode::kUsage, "one FOLDER is needed; see --help"});
  if (word.starts_with('-')) return report({ErrorCode::kUsage, word + ": no such option; see --help"});
  const auto written = splatlas::phantom::write_files(word);
  return written ? 0 : report(written.error());
}
