// splatlas-import-mutants: mutants of source files of all kinds. Each must be imported, or refused in one
// line that names it, within limits of time and memory. Prints a row per kind, and every violation with the
// options that repeat it.

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <map>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "preprocess/import/images/dicom/import_dicom.h"
#include "tests/campaigns/faults/import_kinds.h"
#include "tests/campaigns/faults/mutate.h"
#include "tests/campaigns/faults/own_imports.h"
#include "tests/campaigns/faults/run_import.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string folder;  ///< of files to mutate; empty for those that the program makes
  std::uint32_t mutants = 300, first = 0, seed = 1;
  double cpu_seconds = 20, mebibytes = 4096;
  std::string only, keep;
};

/// A row of the table.
struct Row {
  std::map<Outcome, std::size_t> ends;
  double cpu_seconds = 0, mebibytes = 0;
  std::string slowest, biggest;
};

class ImportMutants {
 public:
  explicit ImportMutants(const Options& options) : options_(options) {
    const fs::path folder = options.folder.empty() ? own_.path() : fs::path(options.folder);
    if (options.folder.empty()) write_own_imports(folder);
    for (const ImportKind& kind : import_kinds()) {
      if (!options.only.empty() && options.only != kind.name) continue;
      if (std::vector<Seed> seeds = find_seeds(kind, folder); !seeds.empty())
        seeds_.emplace_back(&kind, std::move(seeds));
    }
    if (seeds_.empty()) throw std::runtime_error("no file to mutate");
    load_dicom_dictionary();
    adopt_orphans();
  }

  bool run() {
    bool passed = true;
    for (std::uint32_t number = options_.first; number < options_.first + options_.mutants; ++number)
      passed = try_mutant(number) && passed;
    return passed;
  }

  void report() const {
    fmt::print("seed {}, {} mutants\n{:<15} {:>7} {:>8} {:>7} {:>6} {:>8} {:>6}  {}\n", options_.seed,
               options_.mutants, "kind", "results", "refusals", "crashes", "limits", "CPU (s)", "MiB",
               "slowest; biggest");
    for (const auto& [kind, row] : rows_) {
      const auto count = [&ends = row.ends](Outcome outcome) {
        const auto found = ends.find(outcome);
        return found == ends.end() ? std::size_t{0} : found->second;
      };
      fmt::print("{:<15} {:>7} {:>8} {:>7} {:>6} {:>8.2f} {:>6.0f}  {}; {}\n", kind, count(Outcome::kResult),
                 count(Outcome::kRefusal), count(Outcome::kCrashOfChild), count(Outcome::kLimitOfChild),
                 row.cpu_seconds, row.mebibytes, row.slowest, row.biggest);
    }
  }

 private:
  /// Mutant `number` depends on the seed and the number only.
  bool try_mutant(std::uint32_t number) {
    std::seed_seq numbers{options_.seed, number};
    std::mt19937 random(numbers);
    const auto& [kind, seeds] = seeds_[random() % seeds_.size()];
    const Seed& seed = seeds[random() % seeds.size()];
    const TemporaryFolder folder;
    for (const fs::path& companion : seed.companions)
      fs::copy_file(companion, folder.path() / companion.filename());
    const fs::path file = folder.path() / seed.file.filename();
    const std::string bytes = read_bytes(seed.file);
    const Mutant mutant = random() % 2 == 0 ? mutate(bytes, random) : mutate_inflated(bytes, random);
    write_bytes(file, mutant.bytes);
    const std::vector<std::string> before = folder.names();
    ImportRun run = run_import(*kind, kind->takes_folder ? folder.path() : file);
    const std::string& message = run.end.message;
    const std::string name = fmt::format("{} {}", number, seed.file.filename().string());
    if (folder.names() != before) run.violation = "a file is left or gone";
    if (message.find('\n') != std::string::npos) run.violation = "a message of several lines";
    if (!message.empty() && message.find(folder.path().string()) == std::string::npos)
      run.violation = "a message that does not name the file";
    if (run.cpu_seconds > options_.cpu_seconds || run.wall_seconds > 6 * options_.cpu_seconds)
      run.violation = "too slow";
    const double mebibytes = static_cast<double>(run.peak_bytes) / 0x1p20;
    if (mebibytes > options_.mebibytes) run.violation = "too much memory";
    Row& row = rows_[kind->name];
    ++row.ends[run.end.outcome];
    if (run.cpu_seconds > row.cpu_seconds) row.cpu_seconds = run.cpu_seconds, row.slowest = name;
    if (mebibytes > row.mebibytes) row.mebibytes = mebibytes, row.biggest = name;
    const bool is_crash =
        run.end.outcome == Outcome::kCrashOfChild || run.end.outcome == Outcome::kLimitOfChild;
    if (!options_.keep.empty() && (is_crash || !run.violation.empty()))
      write_bytes(fs::path(options_.keep) / fmt::format("{}-{}", options_.seed, name), mutant.bytes);
    if (is_crash || !run.violation.empty()) tell(name, mutant, run, seed);
    return run.violation.empty();
  }

  void tell(const std::string& name, const Mutant& mutant, const ImportRun& run, const Seed& seed) const {
    fmt::print("{}: --seed {} --first {} --mutants 1, {} of {}: {:.1f} s of CPU time, {} MiB: {}\n",
               run.violation.empty() ? "held by the child" : "VIOLATION: " + run.violation, options_.seed,
               name.substr(0, name.find(' ')), mutant.kind, seed.file.string(), run.cpu_seconds,
               run.peak_bytes >> 20, run.end.message);
    std::fflush(stdout);
  }

  const Options& options_;
  TemporaryFolder own_;
  std::vector<std::pair<const ImportKind*, std::vector<Seed>>> seeds_;
  std::map<std::string, Row> rows_;
};

}  // namespace
}  // namespace splatlas

int main(int argc, char** argv) try {
  splatlas::Options options;
  CLI::App app{"Mutants of source files: each is imported or refused, within limits"};
  app.add_option("folder", options.folder, "files to mutate; without it, small ones are made");
  app.add_option("--mutants", options.mutants, "their number")->capture_default_str();
  app.add_option("--first", options.first, "number of the first of them")->capture_default_str();
  app.add_option("--seed", options.seed, "of random numbers")->capture_default_str();
  app.add_option("--only", options.only, "one kind of the table");
  app.add_option("--keep", options.keep, "folder for mutants that end a child");
  app.add_option("--cpu-seconds", options.cpu_seconds, "limit per import")->capture_default_str();
  app.add_option("--mebibytes", options.mebibytes, "limit per import")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  splatlas::ImportMutants mutants(options);
  const bool passed = mutants.run();
  mutants.report();
  return passed ? 0 : 1;
} catch (const std::exception& exception) {
  std::fprintf(stderr, "splatlas-import-mutants: %s\n", exception.what());
  return 1;
}
