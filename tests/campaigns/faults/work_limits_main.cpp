// splatlas-work-limits: small files that ask for much work. The programs must end with a result, or with a
// message that names the budget, within limits of CPU time and memory. Prints the largest of both.

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <sys/resource.h>

#include "tests/campaigns/faults/work_bombs.h"
#include "tests/support/file_bytes.h"
#include "tests/support/run_program.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

struct Limits {
  double cpu_seconds = 1;
  double mebibytes = 640;
  std::string max_work = "0.02";
};

/// The largest cost of one command over all files.
struct Largest {
  double cpu_seconds = 0, mebibytes = 0;
  std::string slowest, biggest;
  std::size_t results = 0, refusals = 0;
};

/// Messages with a limit and a remedy: the budget, limits of other kinds, and missing data.
bool is_refused(const std::string& message) {
  return std::ranges::any_of(
      std::array{"allow it with --max-work", "too many for one sheet; zoom in",
                 "2^31 voxels, too many for rays", "this format cannot hold", "holds no grey values",
                 "was not made from a label map", "can always be written up to"},
      [&](const char* text) { return message.find(text) != std::string::npos; });
}

class WorkLimits {
 public:
  explicit WorkLimits(const Limits& limits) : limits_(limits) {}

  /// Runs every command on a file. Returns false if any exceeds its limits, or ends in another way. A named
  /// file may have a selection of some structures.
  bool try_file(const std::string& name, const std::vector<std::byte>& bytes,
                const std::string& selection = {}) {
    const std::string atlas = folder_.file("a.atlas");
    write_bytes(atlas, bytes);
    bool passed = true;
    std::vector<std::pair<std::string, std::vector<std::string>>> commands{
        {"info", {SPLATLAS_PLAYER, "info", atlas}},
        {"info --json", {SPLATLAS_PLAYER, "info", "--json", atlas}},
        {"verify", {SPLATLAS_PLAYER, "verify", atlas}},
        {"render, volumes",
         {SPLATLAS_PLAYER, "render", atlas, "--size", "64x64", "-o", folder_.file("p.png")}},
        {"render, volumes and surfaces",
         {SPLATLAS_PLAYER, "render", atlas, "--size", "64x64", "--select", "*:both", "--view", "superior",
          "-o", folder_.file("p.png")}},
        {"render, perspective",
         {SPLATLAS_PLAYER, "render", atlas, "--size", "64x64", "--projection", "perspective", "-o",
          folder_.file("p.png")}},
        {"export, labels", {SPLATLAS_PREPROCESS, "export", atlas, "--labels", folder_.file("l.nrrd")}},
        {"export, masks", {SPLATLAS_PREPROCESS, "export", atlas, "--labels", folder_.file("masks/")}},
        {"export, grey values", {SPLATLAS_PREPROCESS, "export", atlas, "--volume", folder_.file("v.nrrd")}},
        {"export, surfaces",
         {SPLATLAS_PREPROCESS, "export", atlas, "--surface", "*=" + folder_.file("s.ply")}}};
    if (!selection.empty()) {
      commands.push_back({"render, some structures",
                          {SPLATLAS_PLAYER, "render", atlas, "--size", "64x64", "--select", selection,
                           "--view", "superior", "-o", folder_.file("p.png")}});
    }
    for (auto& [command, words] : commands) {
      if (!command.starts_with("info")) words.insert(words.end(), {"--max-work", limits_.max_work});
      passed = run(name, command, words) && passed;
    }
    return passed;
  }

  /// Prints a row per command, as in docs/reliability.md.
  void report(std::size_t named, std::size_t random) const {
    std::size_t runs = 0;
    for (const auto& [command, largest] : largest_) runs += largest.results + largest.refusals;
    fmt::print("{} named files, {} random grids, {} points\n{:<29} {:>7} {:>8} {:>8} {:>8}  {}\n", named,
               random, runs, "command", "results", "refusals", "CPU (s)", "MiB", "slowest; biggest");
    for (const auto& [command, largest] : largest_) {
      fmt::print("{:<29} {:>7} {:>8} {:>8.2f} {:>8.0f}  {}; {}\n", command, largest.results, largest.refusals,
                 largest.cpu_seconds, largest.mebibytes, largest.slowest, largest.biggest);
    }
  }

 private:
  bool run(const std::string& file, const std::string& command, const std::vector<std::string>& words) {
    for (const char* output : {"p.png", "l.nrrd", "v.nrrd", "s.ply", "masks"})
      fs::remove_all(folder_.path() / output);
    const ProgramResult result = run_program(words, folder_.path(), {}, [] {
      const rlimit cpu{60, 60};  // ends what would take minutes
      setrlimit(RLIMIT_CPU, &cpu);
    });
    const double seconds = result.cpu_seconds, mebibytes = static_cast<double>(result.peak_bytes) / 0x1p20;
    Largest& largest = largest_of(command);
    if (seconds > largest.cpu_seconds) largest.cpu_seconds = seconds, largest.slowest = file;
    if (mebibytes > largest.mebibytes) largest.mebibytes = mebibytes, largest.biggest = file;
    const bool is_refusal = result.status == 1 && is_refused(result.err);
    ++(is_refusal ? largest.refusals : largest.results);
    if ((result.status != 0 && !is_refusal) || seconds > limits_.cpu_seconds ||
        mebibytes > limits_.mebibytes) {
      fmt::print("{}: {}: status {}, {:.2f} s of CPU time, {:.0f} MiB: {}\n", file, command, result.status,
                 seconds, mebibytes, result.err);
      return false;
    }
    return true;
  }

  Largest& largest_of(const std::string& command) {
    for (auto& [name, largest] : largest_) {
      if (name == command) return largest;
    }
    return largest_.emplace_back(command, Largest{}).second;
  }

  Limits limits_;
  TemporaryFolder folder_;
  std::vector<std::pair<std::string, Largest>> largest_;
};

struct Options {
  Limits limits;
  std::uint32_t giants = 2000, first = 0;
  bool bombs = true;
};

int run(const Options& options) {
  WorkLimits limits(options.limits);
  bool passed = true;
  std::vector<WorkBomb> bombs;
  if (options.bombs) {
    bombs = work_bombs();
    for (const WorkBomb& bomb : bombs)
      passed = limits.try_file(bomb.name, bomb.make(), bomb.selection) && passed;
  }
  for (std::uint32_t seed = options.first; seed < options.first + options.giants; ++seed)
    passed = limits.try_file(fmt::format("giant {}", seed), sparse_giant(seed)) && passed;
  limits.report(bombs.size(), options.giants);
  return passed ? 0 : 1;
}

}  // namespace
}  // namespace splatlas

int main(int argc, char** argv) try {
  splatlas::Options options;
  CLI::App app{
      "Small files that ask for much work: every command ends within its limits, or names the budget"};
  app.add_option("--giants", options.giants, "random sparse grids")->capture_default_str();
  app.add_option("--first", options.first, "number of the first of them")->capture_default_str();
  app.add_flag("!--no-bombs", options.bombs, "leave out the named files");
  app.add_option("--cpu-seconds", options.limits.cpu_seconds, "limit per command")->capture_default_str();
  app.add_option("--mebibytes", options.limits.mebibytes, "limit per command")->capture_default_str();
  app.add_option("--max-work", options.limits.max_work, "of every command")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  return splatlas::run(options);
} catch (const std::exception& exception) {
  std::fprintf(stderr, "splatlas-work-limits: %s\n", exception.what());
  return 1;
}
