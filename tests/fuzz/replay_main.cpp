// Replays files and folders through a fuzz target, without libFuzzer: fuzz-replay TARGET FILE|FOLDER...
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "tests/fuzz/fuzz_target.h"

namespace {

namespace fs = std::filesystem;

std::vector<fs::path> files_of(const fs::path& path) {
  if (!fs::is_directory(path)) return {path};
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(path)) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
}

}  // namespace

int main(int argc, char** argv) {
  const splatlas::FuzzTarget* const target = splatlas::find_target(argc > 1 ? argv[1] : "");
  if (target == nullptr) {
    fmt::print(
        stderr,
        "usage: fuzz-replay TARGET FILE|FOLDER...; a target is a NAME of tests/fuzz/NAME_fuzzer.cpp\n");
    return 2;
  }
  std::size_t count = 0;
  for (int n = 2; n < argc; ++n) {
    for (const fs::path& path : files_of(argv[n])) {
      std::ifstream file(path, std::ios::binary);
      if (!file) {
        fmt::print(stderr, "{}: cannot be read\n", path.string());
        return 1;
      }
      const std::string bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
      // An exact-size copy, so that sanitizers detect reads past its end.
      const std::vector<std::uint8_t> input(bytes.begin(), bytes.end());
      fmt::print("{}\n", path.string());
      std::fflush(stdout);
      target->run(input.data(), input.size());
      ++count;
    }
  }
  fmt::print("{} inputs\n", count);
  return count > 0 ? 0 : 1;
}
