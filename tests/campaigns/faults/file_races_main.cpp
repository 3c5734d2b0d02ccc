// splatlas-file-races: atlases that others truncate, overwrite, replace or remove during opening, verifying
// and rendering. Each time the picture must be right, or an error must name the file. Each attack must have
// an effect in some races.

#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <functional>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "format/atlas_writer.h"
#include "format/result_macros.h"
#include "player/renderer.h"
#include "tests/campaigns/faults/small_atlas.h"
#include "tests/support/file_bytes.h"
#include "tests/support/run_program.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::byte>;

enum class Attack : std::uint8_t { kTruncate, kOverwrite, kWriteOver, kReplace, kRemove, kGrow };
constexpr std::array<const char*, 6> kAttacks{"truncated", "overwritten", "written over",
                                              "replaced",  "removed",     "grown"};

/// In some races of every attack, it is over before the file is opened.
constexpr std::uint32_t kRacesOfOne = 8;
bool is_before(std::uint32_t seed) {
  return seed / kAttacks.size() % kRacesOfOne == 0;
}

/// Progress of the reader.
enum Stage : int { kBegins, kOpened, kSelected, kSeen };

/// Attacks the file once, some time after the reader reaches a stage.
class Attacker {
 public:
  Attacker(const fs::path& path, Attack kind, const Bytes& other, std::uint32_t seed)
      : path_(path), kind_(kind), other_(other), random_(seed) {
    write_bytes(prepared_, other_);
    stage_ = static_cast<int>(random_() % kSeen);
    is_awaited_ = (random_() & 1) != 0;
    if (is_before(seed)) stage_ = kBegins, is_awaited_ = true;
    thread_ = std::thread([this, own_seed = random_()] { wait_and_attack(own_seed); });
  }
  ~Attacker() {
    finish();
    std::error_code ignored;
    fs::remove(prepared_, ignored);
    ::close(descriptor_);
  }
  Attacker(const Attacker&) = delete;
  Attacker& operator=(const Attacker&) = delete;

  /// Waits for the end of the attack. Returns the error number of its system call, 0 for none.
  int finish() {
    reader_ = kSeen;
    if (thread_.joinable()) thread_.join();
    return error_;
  }

  /// Called by the reader. Every other time it waits here until the attack is over.
  void reached(Stage stage) {
    reader_ = stage;
    if (stage != stage_ || !is_awaited_) return;
    while (!done_) std::this_thread::yield();
  }

 private:
  static constexpr std::size_t kMaxNoise = 64;

  static void spin(std::chrono::steady_clock::duration time) {
    for (const auto end = std::chrono::steady_clock::now() + time; std::chrono::steady_clock::now() < end;) {
    }
  }

  void wait_and_attack(std::mt19937::result_type seed) {
    std::mt19937 random(seed);
    const auto place = static_cast<off_t>(random() % other_.size());
    const auto length = 1 + random() % kMaxNoise;
    while (reader_ < stage_) std::this_thread::yield();
    spin(std::chrono::microseconds(random() % 300));
    error_ = change(place, length, random) < 0 ? errno : 0;
    done_ = true;
  }

  /// Returns the result of the system call.
  [[nodiscard]] ssize_t change(off_t place, std::size_t length, std::mt19937& random) const {
    std::array<char, kMaxNoise> noise{};
    for (char& byte : noise) byte = static_cast<char>(random());
    switch (kind_) {
      case Attack::kTruncate: return ::ftruncate(descriptor_, place);
      case Attack::kOverwrite: return ::pwrite(descriptor_, noise.data(), length, place);
      case Attack::kWriteOver: return ::pwrite(descriptor_, other_.data(), other_.size(), 0);
      case Attack::kReplace: return ::rename(prepared_.c_str(), path_.c_str());
      case Attack::kRemove: return ::unlink(path_.c_str());
      case Attack::kGrow: return ::pwrite(descriptor_, noise.data(), length, size_);
    }
    return -1;
  }

  const fs::path& path_;
  Attack kind_;
  const Bytes& other_;
  std::mt19937 random_;
  fs::path prepared_ = path_.string() + ".new";
  int descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CLOEXEC);
  off_t size_ = static_cast<off_t>(fs::file_size(path_));
  int stage_ = 0;
  bool is_awaited_ = false;
  std::atomic<int> reader_{-1};
  std::atomic<bool> done_{false};
  int error_ = 0;  // of the thread; read after it
  std::thread thread_;
};

/// Draws the surfaces, then everything: each picture reads its parts on demand.
Result<std::vector<Picture>> draw_pictures(
    const fs::path& path, bool verify, const std::function<void(Stage)>& reached = [](Stage) {}) {
  reached(kBegins);
  SPLATLAS_ASSIGN_OR_RETURN(const auto atlas, Atlas::open(path));
  reached(kOpened);
  if (verify) SPLATLAS_RETURN_IF_ERROR(atlas->verify());
  Renderer renderer(atlas, {.threads = 2});
  std::vector<Picture> pictures;
  for (const char* text : {"left:surface + ball:surface", "*:both(opacity=0.3)"}) {
    SPLATLAS_ASSIGN_OR_RETURN(const Selection selection, Selection::parse(text, atlas->graph()));
    SPLATLAS_RETURN_IF_ERROR(renderer.select(selection));
    if (!pictures.empty()) reached(kSelected);
    SPLATLAS_ASSIGN_OR_RETURN(Frame frame, renderer.render({.azimuth_deg = 30}, {.size = {24, 24}}));
    // A partial picture reports its missing parts: it counts as an error.
    if (!frame.missing.empty()) return tl::unexpected(frame.missing.front().error);
    pictures.push_back(std::move(frame.picture));
  }
  return pictures;
}

bool are_same(const std::vector<Picture>& a, const std::vector<Picture>& b) {
  return a[0].rgba == b[0].rgba && a[1].rgba == b[1].rgba;
}

struct Tally {
  std::uint64_t old_pictures = 0, new_pictures = 0, errors = 0, wrong = 0;

  /// False if the races gave nothing but the old pictures, although an attack was over before the opening.
  [[nodiscard]] bool has_effect() const {
    return new_pictures + errors + wrong > 0 || old_pictures < kRacesOfOne;
  }
};

class Races {
 public:
  explicit Races(const fs::path& folder)
      : path_(folder / "raced.atlas"),
        atlas_(encode_atlas(small_atlas(1)).value()),
        other_(encode_atlas(small_atlas(2)).value()) {
    write_bytes(path_, other_);
    new_pictures_ = draw_pictures(path_, true).value();
    write_bytes(path_, atlas_);
    old_pictures_ = draw_pictures(path_, true).value();
    if (are_same(old_pictures_, new_pictures_))
      throw std::runtime_error("both atlases draw the same pictures");
  }

  void run(std::uint32_t seed) {
    const auto kind = static_cast<Attack>(seed % kAttacks.size());
    fs::remove(path_);
    write_bytes(path_, atlas_);
    std::optional<Attacker> attacker(std::in_place, path_, kind, other_, seed);
    const auto seen = draw_pictures(path_, seed % 4 == 0, [&](Stage stage) { attacker->reached(stage); });
    const int error = attacker->finish();
    attacker.reset();
    if (error != 0) {
      count_wrong(seed, kind, fmt::format("the attack fails: {}", std::strerror(error)));
    } else {
      judge(seed, kind, seen);
    }
  }

  [[nodiscard]] std::uint64_t report() const {
    std::uint64_t wrong = 0;
    fmt::print("{:14} {:>12} {:>12} {:>8} {:>8}\n", "the file is", "old pictures", "new pictures", "errors",
               "wrong");
    for (std::size_t n = 0; n < kAttacks.size(); ++n) {
      const Tally& tally = tallies_[n];
      fmt::print("{:14} {:12} {:12} {:8} {:8}\n", kAttacks[n], tally.old_pictures, tally.new_pictures,
                 tally.errors, tally.wrong);
      wrong += tally.wrong;
      if (tally.has_effect()) continue;
      fmt::print("  {}: no effect in {} races\n", kAttacks[n], tally.old_pictures);
      ++wrong;
    }
    return wrong;
  }

 private:
  void judge(std::uint32_t seed, Attack kind, const Result<std::vector<Picture>>& seen) {
    Tally& tally = tallies_[static_cast<std::size_t>(kind)];
    if (!seen && seen.error().message.find(path_.string() + ": ") == 0) {
      ++tally.errors;
    } else if (seen && are_same(*seen, old_pictures_)) {
      ++tally.old_pictures;
    } else if (seen && are_same(*seen, new_pictures_) &&
               (kind == Attack::kReplace || kind == Attack::kWriteOver)) {
      ++tally.new_pictures;
    } else {
      count_wrong(seed, kind, seen ? "a picture of neither atlas" : seen.error().message);
    }
  }

  void count_wrong(std::uint32_t seed, Attack kind, const std::string& what) {
    ++tallies_[static_cast<std::size_t>(kind)].wrong;
    fmt::print("--first {} --races 1: {}: {}\n", seed, kAttacks[static_cast<std::size_t>(kind)], what);
  }

  fs::path path_;
  Bytes atlas_, other_;
  std::vector<Picture> old_pictures_, new_pictures_;
  std::array<Tally, kAttacks.size()> tallies_;
};

}  // namespace
}  // namespace splatlas

int main(int argc, char** argv) try {
  CLI::App app{"Concurrent changes of an open atlas", "splatlas-file-races"};
  std::uint32_t races = 10000, first = 0;
  app.add_option("--races", races, "number of races")->capture_default_str();
  app.add_option("--first", first, "number of the first race")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  const splatlas::TemporaryFolder folder;
  splatlas::Races all(folder.path());
  for (std::uint32_t n = 0; n < races; ++n) all.run(first + n);
  const std::uint64_t wrong = all.report();
  fmt::print("{} races, {} wrong\n", races, wrong);
  return wrong == 0 ? 0 : 1;
} catch (const std::exception& exception) {
  std::fprintf(stderr, "splatlas-file-races: %s\n", exception.what());
  return 1;
}
