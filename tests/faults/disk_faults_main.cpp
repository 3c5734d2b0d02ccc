// splatlas-disk-faults: kills, errors and short transfers at every system call on a file, in every command
// that writes. Afterwards the output must be the old file or the complete new one, and exit status and
// message must match.

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <fstream>
#include <map>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "tests/faults/run_harness.h"
#include "tests/faults/run_with_fault.h"
#include "tests/support/file_bytes.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;
using Kind = Fault::Kind;
using Effect = FileCall::Effect;

constexpr int kKilled = 128 + 9;

/// A command of either program that writes files, over an existing output.
struct FaultScenario {
  std::string name;
  std::vector<std::string> words;  ///< command line, to be run in the folder
  std::string output;              ///< file or folder that it creates or replaces
  bool replaces = true;            ///< an old output exists
};

constexpr unsigned kSize = 20;

/// Two structures, one in each half of the grid, and noise as grey values.
void write_sources(const fs::path& folder) {
  const std::string header = fmt::format(
      "ObjectType = Image\nNDims = 3\nDimSize = {0} {0} {0}\nElementType = MET_UCHAR\n"
      "ElementDataFile = LOCAL\n",
      kSize);
  std::string labels, greys;
  std::mt19937 random(1);
  for (unsigned v = 0; v < kSize * kSize * kSize; ++v) {
    const unsigned i = v % kSize, j = v / kSize % kSize, k = v / kSize / kSize;
    const bool is_inside = i > 2 && i < 17 && j > 3 && j < 16 && k > 2 && k < 15;
    labels += static_cast<char>(is_inside ? 1 + (i > 9 ? 1 : 0) : 0);
    greys += static_cast<char>(random() % 256);
  }
  std::ofstream(folder / "labels.mha", std::ios::binary) << header << labels;
  std::ofstream(folder / "volume.mha", std::ios::binary) << header << greys;
  std::ofstream(folder / "names.txt") << "1 left\n2 right\n";
}

std::vector<std::string> build_words(const std::string& output) {
  return {SPLATLAS_PREPROCESS, "build",      "-o",      output,      "--labels",   "labels.mha",
          "--volume",          "volume.mha", "--names", "names.txt", "--progress", "none"};
}

FaultScenario exported(const std::string& output, const std::string& option, const std::string& value,
                       bool replaces = true) {
  return {"export " + output, {SPLATLAS_PREPROCESS, "export", "in.atlas", option, value}, output, replaces};
}

/// Writes a small volume, its labels and an atlas of them into the folder.
void prepare_inputs(const fs::path& folder) {
  write_sources(folder);
  const ProgramResult built = run_program(build_words("in.atlas"), folder);
  if (built.status != 0) throw std::runtime_error("cannot build the atlas: " + built.err);
}

/// Builds, exports of every kind and pictures in every format.
std::vector<FaultScenario> fault_scenarios() {
  std::vector<FaultScenario> scenarios{{"build", build_words("out.atlas"), "out.atlas"},
                                       {"build --compact", build_words("out.atlas"), "out.atlas"}};
  scenarios[1].words.emplace_back("--compact");
  for (const char* format : {"nrrd", "nii", "nii.gz", "mha"}) {
    scenarios.push_back(
        exported(fmt::format("labels.{}", format), "--labels", fmt::format("labels.{}", format)));
  }
  scenarios[5].output = scenarios[5].words[4] = "exported.mha";  // labels.mha is an input
  scenarios.push_back(exported("volume.nrrd", "--volume", "volume.nrrd"));
  scenarios.push_back(exported("masks", "--labels", "masks/", false));
  for (const char* format : {"stl", "ply", "obj", "vtk"}) {
    scenarios.push_back(
        exported(fmt::format("surface.{}", format), "--surface", fmt::format("left=surface.{}", format)));
  }
  for (const char* format : {"png", "jpg", "tif", "exr"}) {
    const std::string output = fmt::format("picture.{}", format);
    scenarios.push_back({"render " + output,
                         {SPLATLAS_PLAYER, "render", "in.atlas", "-o", output, "--select",
                          "left + right:surface", "--size", "32x32", "--threads", "1"},
                         output});
  }
  return scenarios;
}

/// Names and bytes of everything below a file or folder; empty when it does not exist.
std::map<std::string, std::string> tree_of(const fs::path& path) {
  std::map<std::string, std::string> tree;
  if (!fs::is_directory(path)) {
    if (fs::exists(path)) tree[""] = read_bytes(path);
    return tree;
  }
  for (const auto& entry : fs::recursive_directory_iterator(path))
    tree[fs::relative(entry.path(), path)] = entry.is_directory() ? "" : read_bytes(entry.path());
  return tree;
}

/// The faults to inject at a call.
std::vector<Fault> faults_at(const FileCall& call) {
  std::vector<Fault> faults{{Kind::kKill, 0, false, "kill -9"},
                            {Kind::kError, EIO, false, "EIO"},
                            {Kind::kError, EIO, true, "EIO, lasting"}};
  if (call.effect == Effect::kStores) {
    faults.push_back({Kind::kError, ENOSPC, false, "ENOSPC"});
    faults.push_back({Kind::kError, ENOSPC, true, "ENOSPC, lasting"});
  }
  if (call.transfers) {
    faults.push_back({Kind::kError, EINTR, false, "EINTR"});
    faults.push_back({Kind::kShort, 0, false, "short"});
    faults.push_back({Kind::kShort, EIO, true, "short, then EIO"});
    if (call.effect == Effect::kStores) {
      faults.push_back({Kind::kShort, ENOSPC, true, "short, then ENOSPC"});
      faults.push_back({Kind::kTear, 0, false, "kill -9 half way"});
    }
  }
  return faults;
}

/// Outcomes of the points of a scenario.
struct Tally {
  std::size_t calls = 0, points = 0, old_kept = 0, new_whole = 0, killed = 0, wrong = 0;
};

/// One command, repeated over the same old output.
class Rehearsal {
 public:
  Rehearsal(const FaultScenario& scenario, fs::path folder)
      : scenario_(scenario), folder_(std::move(folder)), output_(folder_ / scenario.output) {
    put_old();
    old_ = tree_of(output_);
    usual_ = run_with_fault(scenario_.words, folder_);
    if (usual_.result.status != 0) throw std::runtime_error(scenario_.name + ": " + usual_.result.err);
    new_ = tree_of(output_);
    if (new_ == old_) throw std::runtime_error(scenario_.name + ": changes nothing");
    names_ = names();
    tally_.calls = usual_.calls.size();
  }

  [[nodiscard]] const std::vector<FileCall>& calls() const { return usual_.calls; }
  [[nodiscard]] const Tally& tally() const { return tally_; }

  void strike(std::size_t number, const Fault& fault) {
    put_old();
    const FaultyRun run = run_with_fault(scenario_.words, folder_, number, fault);
    ++tally_.points;
    const std::string complaint = judge(run.result, fault);
    if (complaint.empty()) return;
    ++tally_.wrong;
    fmt::print("  {}: {} at call {} ({}): {}; status {}: {}\n", scenario_.name, fault.name, number,
               usual_.calls[number].name, complaint, run.result.status, run.result.err);
  }

 private:
  void put_old() const {
    fs::remove_all(output_);
    if (scenario_.replaces) std::ofstream(output_, std::ios::binary) << "the old file";
  }

  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_)) names.push_back(entry.path().filename());
    std::ranges::sort(names);
    return names;
  }

  /// The fault after a run; empty for none.
  [[nodiscard]] std::string judge(const ProgramResult& result, const Fault& fault) {
    const auto found = tree_of(output_);
    const bool is_new = found == new_, is_old = found == old_;
    const bool kills = fault.kind == Kind::kKill || fault.kind == Kind::kTear;
    // Unreadable chunks cost their structures: the program draws the rest and says so.
    const bool is_rest = result.status == 3 && result.err.ends_with("was written without what is missing\n");
    ++(result.status == kKilled ? tally_.killed : is_new || is_rest ? tally_.new_whole : tally_.old_kept);
    if (is_rest) return judge_debris(fault.lasts);
    if (!is_new && !is_old) return "the output is neither the old one nor the new one";
    if (kills && result.status != 0 && result.status != kKilled) return "another status than SIGKILL's";
    if (!kills && result.status != 0 && result.status != 1) return "another status than 0 and 1";
    if (result.status == 0 && !is_new) return "success with the old output";
    if (result.status == 1) {
      if (is_new && result.err.find("is written whole") == std::string::npos)
        return "failure with the new output";
      if (!names_a_file(result.err)) return "the message is not one line with a file's name";
    }
    return judge_debris(kills || fault.lasts);
  }

  /// Temporaries must be gone; after a failed removal, the next run must remove them.
  [[nodiscard]] std::string judge_debris(bool may_leave) const {
    const auto is_known = [&](const std::string& name) { return std::ranges::binary_search(names_, name); };
    if (std::ranges::all_of(names(), is_known)) return "";
    if (!may_leave) return "a temporary remains";
    fs::remove_all(output_);
    const FaultyRun again = run_with_fault(scenario_.words, folder_);
    if (again.result.status != 0) return "the next run fails: " + again.result.err;
    if (tree_of(output_) != new_) return "the next run writes something else";
    return names() == names_ ? "" : "a temporary remains after the next run";
  }

  [[nodiscard]] bool names_a_file(const std::string& message) const {
    const bool is_one_line = std::ranges::count(message, '\n') == 1 && message.back() == '\n';
    return is_one_line && std::ranges::any_of(names_, [&](const std::string& name) {
             return message.find(name) != std::string::npos;
           });
  }

  const FaultScenario& scenario_;
  fs::path folder_, output_;
  std::map<std::string, std::string> old_, new_;  // by name
  FaultyRun usual_;
  std::vector<std::string> names_;
  Tally tally_;
};

int run(const ChosenPoints& chosen) {
  const TemporaryFolder temporary;
  const fs::path folder = fs::canonical(temporary.path());
  prepare_inputs(folder);
  fmt::print("{:24} {:>6} {:>7} {:>7} {:>7} {:>7} {:>7}\n", "command", "calls", "points", "killed", "old",
             "new", "wrong");
  Tally sum;
  std::size_t number = 0;
  for (const FaultScenario& scenario : fault_scenarios()) {
    if (scenario.name.find(chosen.only) == std::string::npos) continue;
    Rehearsal rehearsal(scenario, folder);
    for (std::size_t call = 0; call < rehearsal.calls().size(); ++call) {
      for (const Fault& fault : faults_at(rehearsal.calls()[call])) {
        if (number++ % chosen.every == chosen.first) rehearsal.strike(call, fault);
      }
    }
    const Tally& tally = rehearsal.tally();
    fmt::print("{:24} {:6} {:7} {:7} {:7} {:7} {:7}\n", scenario.name, tally.calls, tally.points,
               tally.killed, tally.old_kept, tally.new_whole, tally.wrong);
    std::fflush(stdout);
    sum.points += tally.points;
    sum.wrong += tally.wrong;
    fs::remove_all(folder / scenario.output);
  }
  fmt::print("{} of {} points, {} wrong\n", sum.points, number, sum.wrong);
  return sum.points > 0 && sum.wrong == 0 ? 0 : 1;
}

}  // namespace
}  // namespace splatlas

int main(int argc, char** argv) {
  return splatlas::run_harness(argc, argv, "splatlas-disk-faults",
                               "Faults at every system call on a file, in every command that writes",
                               splatlas::run);
}
