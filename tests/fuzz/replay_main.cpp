// Replays files and folders through a fuzz target, without libFuzzer: its corpus as a test.
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <fmt/format.h>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

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
  std::size_t count = 0;
  for (int n = 1; n < argc; ++n) {
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
      LLVMFuzzerTestOneInput(input.data(), input.size());
      ++count;
    }
  }
  fmt::print("{} inputs\n", count);
  return count > 0 ? 0 : 1;
}
