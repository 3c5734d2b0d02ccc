// splatlas-import-mutants: mutants of source files of all kinds. Each must be imported, or refused in one
// line that names it, within limits of time and memory. Prints a row per kind, and every violation with the
// options that repeat it.

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
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
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "preprocess/import/images/pixels/image_readers.h"
#include "tests/campaigns/faults/import_kinds.h"
#include "tests/campaigns/faults/mutate.h"
#include "tests/preprocess/import/images/dicom/dicom_files.h"
#include "tests/preprocess/import/planted_files.h"
#include "tests/preprocess/import/side_volumes.h"
#include "tests/preprocess/raw_image_files.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

void write(const fs::path& path, const std::string& bytes) {
  fs::create_directories(path.parent_path());
  if (!write_bytes(path, bytes)) throw std::runtime_error(path.string() + ": cannot be written");
}

/// 8 x 6 grey pixels of 8 bits.
std::string png(char value) {
  const std::string row = std::string(1, '\0') + std::string(8, value);
  std::string rows;
  for (int n = 0; n < 6; ++n) rows += row;
  return "\x89PNG\r\n\x1a\n" +
         png_chunk("IHDR", big_endian(8) + big_endian(6) + std::string("\x8\0\0\0\0", 5)) +
         png_chunk("IDAT", deflated(rows, false)) + png_chunk("IEND", "");
}

void write_dicom(const fs::path& folder) {
  fs::create_directories(folder / "series");
  for (int k = 0; k < 5; ++k) {
    TestSlice slice;
    slice.position = {0, 0, 2. * k};
    slice.stored.assign(TestSlice::kPixels, static_cast<std::uint16_t>(k));
    constexpr std::array kCodings{TestCoding::kExplicit, TestCoding::kRunLengths, TestCoding::kJpegLossless,
                                  TestCoding::kDeflated, TestCoding::kJpegLs};
    write_slice(slice, folder / "series" / fmt::format("{}.dcm", k),
                kCodings.at(static_cast<std::size_t>(k)));
  }
  TestSegmentation segmentation;
  segmentation.segments = {{1, "Liver", {34902, 53485, 50171}, "SCT", "10200004", ""}};
  for (const double z : {0., 2., 4.})
    segmentation.frames.push_back({1, z, std::vector<std::uint16_t>(TestSegmentation::kPixels, 1)});
  write_segmentation(segmentation, folder / "seg.dcm");
}

/// Small files of every kind below `folder`, made by our own writers. Throws std::runtime_error.
void write_own_imports(const fs::path& folder) {
  Planter plant;
  for (const PlantedFile& file : planted_images(plant)) write(folder / file.name, file.bytes);
  for (const PlantedFile& file : planted_meshes(plant)) write(folder / file.name, file.bytes);
  write(
      folder / "a.vtp",
      "<VTKFile type=\"PolyData\" version=\"0.1\" byte_order=\"LittleEndian\"><PolyData><Piece "
      "NumberOfPoints=\"3\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"1\">"
      "<Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 0"
      "</DataArray></Points><Polys><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 2"
      "</DataArray><DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">3</DataArray></Polys></Piece>"
      "</PolyData></VTKFile>\n");
  write(folder / "lh.pial", "\377\377\376a\n\n" + big_endian(3) + big_endian(1) + std::string(36, '@') +
                                big_endian(0) + big_endian(1) + big_endian(2) +
                                "valid = 1\ncras   = 1 2 3\n");
  const std::string mask = deflated(nifti_by_sform(placed(Body(), {})), true);
  for (const char* name : {"liver.nii.gz", "spleen.nii.gz", "aorta.nii.gz"})
    write(folder / "masks" / name, mask);
  for (const char value : {'\1', '\2', '\3'})
    write(folder / "stack" / fmt::format("{}.png", int{value}), png(value));
  write_dicom(folder);
  write(folder / "itksnap.label", "    0  0 0 0  0 0 0 \"Clear\"\n    1  255 0 0  1 1 1 \"Liver\"\n");
  write(folder / "lut.txt", "# id name\n1 Left-Lung 220 216 20 0\n2 Right-Lung 220 216 20 0\n");
  write(folder / "dseg.tsv", "index\tname\tcolor\n1\tLiver\t#781283\n2\tSpleen\t#d03e52\n");
  write(folder / "table.csv", "id,name,parent\n1,Body,\n2,\"Lung, left\",1\n");
  write(folder / "allen.json",
        R"([{"id":1,"name":"root","acronym":"r","color_hex_triplet":"FFFFFF","children":[{"id":2,"name":"a",)"
        R"("acronym":"a","color_hex_triplet":"7ED04B","children":[]}]}])");
  write(folder / "map.json", R"({"1": "spleen", "2": "kidney"})");
  write(folder / "paths.tree", "Body/Lungs/Left lung\nBody/Lungs/#2 color=#ff0000\n");
}

/// One import in a process of its own, measured.
struct ImportRun {
  ImportEnd end;
  double cpu_seconds = 0, wall_seconds = 0;
  std::uint64_t peak_bytes = 0;  ///< of the process and of its children
  std::string violation;         ///< empty if the process ended as it should
};

std::ptrdiff_t open_files() {
  return std::distance(fs::directory_iterator("/proc/self/fd"), fs::directory_iterator());
}

/// The import in the process that must survive. Writes a digit for the outcome and the message.
[[noreturn]] void import_and_exit(const ImportKind& kind, const fs::path& path, int answer) {
  std::string text;
  try {
    const std::ptrdiff_t files = open_files();
    const ImportEnd end = kind.import(path);
    text = fmt::format("{}{}", static_cast<int>(end.outcome), end.message);
    if (::waitpid(-1, nullptr, WNOHANG) != -1 || errno != ECHILD) text = "?leaves a child";
    if (open_files() != files) text = "?leaves an open file";
  } catch (const std::exception& exception) {
    text = fmt::format("?throws {}", exception.what());
  }
  const auto written = ::write(answer, text.data(), text.size());
  ::_exit(written == static_cast<ssize_t>(text.size()) ? 0 : 1);
}

/// Reads to the end, for at most `seconds` without a byte.
std::string read_all(int file, int seconds) {
  std::string text;
  std::array<char, 4096> piece{};
  pollfd readable{file, POLLIN, 0};
  while (::poll(&readable, 1, seconds * 1000) == 1) {
    const ssize_t count = ::read(file, piece.data(), piece.size());
    if (count <= 0) break;
    text.append(piece.data(), static_cast<std::size_t>(count));
  }
  return text;
}

/// What `text` and `status` of the process say.
void judge(const std::string& text, int status, ImportRun& run) {
  if (WIFSIGNALED(status)) {
    run.violation = fmt::format("the process was ended by signal {}", WTERMSIG(status));
  } else if (text.empty() || WEXITSTATUS(status) != 0) {
    run.violation = fmt::format("the process exited with status {}", WEXITSTATUS(status));
  } else if (text.front() == '?') {
    run.violation = "the process " + text.substr(1);
  } else {
    run.end = {static_cast<Outcome>(text.front() - '0'), text.substr(1)};
  }
}

/// Makes processes that lose their parent children of this one, so that run_import() sees them.
void adopt_orphans() {
  ::prctl(PR_SET_CHILD_SUBREAPER, 1);
}

/// Runs `kind.import`. A violation: a crash, a hang, or a process or an open file that is left behind.
ImportRun run_import(const ImportKind& kind, const fs::path& path) {
  constexpr int kHangs = 200;  // seconds
  const auto begun = std::chrono::steady_clock::now();
  std::array<int, 2> ends{};
  if (::pipe(ends.data()) != 0) throw std::runtime_error("no pipe can be made");
  const pid_t process = ::fork();
  if (process < 0) throw std::runtime_error("no process can be made");
  if (process == 0) import_and_exit(kind, path, ends[1]);
  ::close(ends[1]);
  const std::string text = read_all(ends[0], kHangs);
  ::close(ends[0]);
  if (text.empty()) ::kill(process, SIGKILL);
  ImportRun run;
  rusage usage{};
  int status = 0;
  while (::wait4(process, &status, 0, &usage) < 0 && errno == EINTR) {
  }
  judge(text, status, run);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  run.cpu_seconds = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  run.wall_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  run.peak_bytes = static_cast<std::uint64_t>(usage.ru_maxrss) << 10;
  if (::waitpid(-1, nullptr, WNOHANG) != -1) run.violation = "a process of the reader is left";
  return run;
}

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
