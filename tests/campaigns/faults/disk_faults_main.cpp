// splatlas-disk-faults: kills, errors and short transfers at every system call on a file, in every command
// that writes. Afterwards the output must be the old file or the complete new one, and exit status and
// message must match. No command may remove, rename or open for writing a name that it did not create.

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <map>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "tests/campaigns/faults/run_harness.h"
#include "tests/campaigns/faults/run_with_fault.h"
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
  Naming naming = Naming::kUnnamed;
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

/// Builds, masks and pictures without an old output, and on a file system without unnamed files.
void add_variants(std::vector<FaultScenario>& scenarios) {
  const std::vector<FaultScenario> originals = scenarios;
  for (const FaultScenario& original : originals) {
    if (original.output != "out.atlas" && original.output != "picture.png" && original.output != "masks")
      continue;
    FaultScenario variant = original;
    variant.naming = Naming::kNamed;
    variant.name = original.name + ", named";
    scenarios.push_back(variant);
    if (!original.replaces) continue;
    variant = original;
    variant.replaces = false;
    variant.name = original.name + ", new";
    scenarios.push_back(variant);
  }
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
  add_variants(scenarios);
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

/// Names that a run has created and not renamed to its output or removed.
class CreatedNames {
 public:
  explicit CreatedNames(fs::path output) : output_(std::move(output)) {}

  /// Follows a call. False if it changes a name that neither is the output nor was created.
  bool follow(const FileCall& call) {
    using Use = FileCall::NameUse;
    if (call.use == Use::kNone || is_in(call.path, output_)) return true;
    if (call.use == Use::kCreates) return names_.insert(call.path).second;
    if (names_.erase(call.path) == 0) return false;
    const bool removes = call.name.starts_with("unlink") || call.name == "rmdir";
    if (call.target.empty() && !removes) names_.insert(call.path);
    if (!call.target.empty() && !is_in(call.target, output_)) names_.insert(call.target);
    return true;
  }
  /// Number of these names in the folder itself.
  [[nodiscard]] std::size_t count_in(const fs::path& folder) const {
    return static_cast<std::size_t>(std::ranges::count(names_, folder, &fs::path::parent_path));
  }

 private:
  fs::path output_;
  std::set<fs::path> names_;
};

/// Checks a whole run: every changed name was created by it, nothing is left of them, and atlases are read
/// through their mapping. Returns the first fault; empty for none.
std::string judge_calls(const FaultyRun& run, const fs::path& folder, const fs::path& output) {
  CreatedNames created(output);
  for (const FileCall& call : run.calls) {
    if (!created.follow(call)) return call.name + " changes a foreign name: " + call.path.string();
    if (call.transfers && call.path.extension() == ".atlas")
      return call.name + " of an atlas beside its mapping: " + call.path.string();
  }
  for (const FileCall& call : run.outside) {
    if (!is_in(call.path, "/proc/self/fd") && !is_in(call.path, "/dev"))
      return call.name + " outside the folder of its output: " + call.path.string();
  }
  return created.count_in(folder) == 0 ? "" : "a name remains";
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
    usual_ = run_with_fault(scenario_.words, folder_, scenario_.naming);
    if (usual_.result.status != 0) throw std::runtime_error(scenario_.name + ": " + usual_.result.err);
    if (const std::string fault = judge_calls(usual_, folder_, output_); !fault.empty())
      throw std::runtime_error(scenario_.name + ": " + fault);
    new_ = tree_of(output_);
    if (new_ == old_) throw std::runtime_error(scenario_.name + ": changes nothing");
    names_ = names();
    tally_.calls = usual_.calls.size();
  }

  [[nodiscard]] const std::vector<FileCall>& calls() const { return usual_.calls; }
  [[nodiscard]] const Tally& tally() const { return tally_; }

  void strike(std::size_t number, const Fault& fault) {
    put_old();
    const FaultyRun run = run_with_fault(scenario_.words, folder_, scenario_.naming, number, fault);
    ++tally_.points;
    const std::string complaint = judge(run, number, fault);
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
  [[nodiscard]] std::string judge(const FaultyRun& run, std::size_t number, const Fault& fault) {
    const ProgramResult& result = run.result;
    const auto found = tree_of(output_);
    const bool is_new = found == new_, is_old = found == old_;
    const bool kills = fault.kind == Kind::kKill || fault.kind == Kind::kTear;
    // Unreadable chunks cost their structures: the program draws the rest and says so.
    const bool is_rest = result.status == 3 && result.err.ends_with("was written without what is missing\n");
    ++(result.status == kKilled ? tally_.killed : is_new || is_rest ? tally_.new_whole : tally_.old_kept);
    // Only the kernel cleans up after a kill, and nobody while removals fail.
    const std::size_t kept = kills ? names_before(number) : 0;
    const std::size_t may_keep = kills ? kept : (fault.lasts ? 1 : 0);
    if (is_rest) return judge_debris(kept, may_keep);
    if (!is_new && !is_old) return "the output is neither the old one nor the new one";
    if (kills && result.status != 0 && result.status != kKilled) return "another status than SIGKILL's";
    if (!kills && result.status != 0 && result.status != 1) return "another status than 0 and 1";
    if (result.status == 0 && !is_new) return "success with the old output";
    if (result.status == 1) {
      if (is_new && result.err.find("is written whole") == std::string::npos)
        return "failure with the new output";
      if (!names_a_file(result.err)) return "the message is not one line with a file's name";
    }
    return judge_debris(result.status == kKilled ? kept : 0, may_keep);
  }

  /// Number of temporaries with names before the call of this number.
  [[nodiscard]] std::size_t names_before(std::size_t number) const {
    CreatedNames created(output_);
    for (std::size_t n = 0; n < number; ++n) created.follow(usual_.calls[n]);
    return created.count_in(folder_);
  }

  /// At least `kept` and at most `may_keep` temporaries may remain, one at most. The next run must succeed
  /// and leave them alone.
  [[nodiscard]] std::string judge_debris(std::size_t kept, std::size_t may_keep) const {
    std::vector<std::string> debris;
    std::ranges::set_difference(names(), names_, std::back_inserter(debris));
    if (debris.empty() && kept == 0) return "";
    if (debris.size() < kept || debris.size() > may_keep || may_keep > 1)
      return fmt::format("{} temporaries remain, expected {} to {}", debris.size(), kept, may_keep);
    fs::remove_all(output_);
    const FaultyRun again = run_with_fault(scenario_.words, folder_);
    if (again.result.status != 0) return "the next run fails: " + again.result.err;
    if (tree_of(output_) != new_) return "the next run writes something else";
    const bool stays = fs::exists(folder_ / debris[0]);
    fs::remove_all(folder_ / debris[0]);
    return stays ? "" : "the next run removes an entry of another process";
  }

  [[nodiscard]] bool names_a_file(std::string message) const {
    // Notes on the inputs come before the error.
    while (message.starts_with("note: ") || message.starts_with("warning: "))
      message.erase(0, message.find('\n') + 1);
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
