// splatlas-flip-bytes: opens and draws damaged copies of an atlas (flipped_file.h).
#include <algorithm>
#include <array>
#include <cstdio>
#include <ctime>
#include <exception>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <sys/resource.h>

#include "format/atlas_writer.h"
#include "tests/damage/flipped_file.h"
#include "tests/support/phantom_content.h"

namespace {

using splatlas::Bytes;
using splatlas::Outcome;

Bytes bytes_of_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error(path + ": cannot be read");
  const std::vector<char> chars{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  const auto bytes = std::as_bytes(std::span(chars));
  return Bytes(bytes.begin(), bytes.end());
}

/// Counts outcomes and keeps the maximum CPU time of a file.
class Tally {
 public:
  template <typename Damage>
  void add(const std::string& where, splatlas::FlippedFiles& files, const Damage& damage) {
    const std::clock_t start = std::clock();
    const Outcome outcome = damage();
    slowest_ms_ = std::max(slowest_ms_, 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
    ++counts_[static_cast<std::size_t>(outcome)];
    if (outcome == Outcome::kWrong) fmt::print("{}: {}\n", where, files.remark());
  }
  [[nodiscard]] std::size_t of(Outcome outcome) const { return counts_[static_cast<std::size_t>(outcome)]; }
  [[nodiscard]] double slowest_ms() const { return slowest_ms_; }

 private:
  std::array<std::size_t, 5> counts_{};
  double slowest_ms_ = 0;
};

long peak_mebibytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss / 1024;
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app(
      "Flips bytes of an atlas and cuts it short, each time of the good file, and draws what lies there. "
      "Exit status "
      "1 when damage is not told, or changes a picture otherwise.");
  std::string atlas;
  std::uint32_t seed = 1;
  std::size_t flips = 1000, cuts = 1000;
  app.add_option("ATLAS", atlas, "a good atlas; the paper's phantom when there is none");
  app.add_option("--flips", flips, "how many bytes")->capture_default_str();
  app.add_option("--cuts", cuts, "how many lengths")->capture_default_str();
  app.add_option("--seed", seed, "of the places")->capture_default_str();
  CLI11_PARSE(app, argc, argv);

  splatlas::FlippedFiles files(atlas.empty() ? splatlas::encode_atlas(splatlas::phantom_content()).value()
                                             : bytes_of_file(atlas));
  std::mt19937 random(seed);
  std::uniform_int_distribution<std::size_t> place(0, files.bytes() - 1);
  Tally tally;
  for (std::size_t n = 0; n < flips; ++n) {
    const std::size_t byte = place(random);
    const auto mask = static_cast<std::uint8_t>(1 + random() % 255);
    tally.add(fmt::format("byte {} ^ {:#04x}", byte, mask), files,
              [&] { return files.flip(byte, mask, random); });
  }
  for (std::size_t n = 0; n < cuts; ++n) {
    const std::size_t length = place(random);
    tally.add(fmt::format("{} bytes", length), files, [&] { return files.truncate(length); });
  }
  fmt::print(
      "{} bytes flipped, {} lengths: {} refused, {} told that nothing can be drawn, {} told what is missing "
      "from the "
      "picture of the rest, {} unharmed, {} wrong. At most {:.1f} ms of CPU time a file, {} MiB in all.\n",
      flips, cuts, tally.of(Outcome::kRefused), tally.of(Outcome::kNothing), tally.of(Outcome::kRest),
      tally.of(Outcome::kUnharmed), tally.of(Outcome::kWrong), tally.slowest_ms(), peak_mebibytes());
  return tally.of(Outcome::kWrong) == 0 ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "splatlas-flip-bytes: %s\n", error.what());
  return 1;
}
