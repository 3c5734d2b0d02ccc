// fuzz-seeds: writes the seeds of binary formats, FOLDER/TARGET/NUMBER.
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "format/atlas_writer.h"
#include "format/codec/run_codec.h"
#include "format/codec/value_codec.h"
#include "format/content/run_model.h"
#include "tests/fuzz/seed_atlases.h"
#include "tests/support/file_bytes.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::byte>;

class SeedWriter {
 public:
  explicit SeedWriter(fs::path folder) : folder_(std::move(folder)) {}

  void write_of(const AtlasContent& content, const Bytes& file) {
    write_file(file);
    for (ClassId c = 1; c < content.classes.size(); ++c) write_runs(content, c);
    write_values(content);
  }
  void write_file(const Bytes& file) { write("atlases", file); }
  [[nodiscard]] std::size_t count() const { return count_; }

 private:
  template <typename T>
  static void append(const T& value, Bytes& bytes) {
    std::ranges::copy(std::as_bytes(std::span(&value, 1)), std::back_inserter(bytes));
  }
  static void append(const Bytes& from, Bytes& bytes) { std::ranges::copy(from, std::back_inserter(bytes)); }

  void write_runs(const AtlasContent& content, ClassId c) {
    const Index3 size = storage_grid(content).size;
    for (const Axis axis : kAxes) {
      Bytes seed;
      for (const std::int64_t n : size) append(static_cast<std::uint8_t>(n - 1), seed);
      append(static_cast<std::uint8_t>(axis), seed);
      append_run_list(encode_runs(content.class_volume, size, axis, content.classes.size()).classes[c], seed);
      write("run_lists", seed);
    }
  }

  /// All voxels: raw values and their code.
  void write_values(const AtlasContent& content) {
    if (content.values.empty()) return;
    const Index3 size = storage_grid(content).size;
    std::vector<ClassSpan> spans = gaps_between({}, size);
    const GroupVoxels all{spans,
                          static_cast<std::uint64_t>(storage_grid(content).voxels()),
                          {{0, 0, 0}, {size[0] - 1, size[1] - 1, size[2] - 1}},
                          size[1]};
    const auto type = static_cast<std::uint8_t>(static_cast<unsigned>(content.values.type) - 1);
    for (const bool coded : {false, true}) {
      Bytes seed;
      for (const std::int64_t n : size) append(static_cast<std::uint8_t>(n - 1), seed);
      append(static_cast<std::uint8_t>(coded ? type : type | 0x80), seed);
      append(std::uint8_t{0}, seed);  // runs
      append(coded ? encode_values(all, content.values.type, content.values.bytes) : content.values.bytes,
             seed);
      write("values", seed);
    }
  }

  void write(const std::string& target, const Bytes& bytes) {
    fs::create_directories(folder_ / target);
    const fs::path path = folder_ / target / fmt::format("{:04}", count_++);
    if (!write_bytes(path, bytes)) throw std::runtime_error(path.string() + ": cannot be written");
  }

  fs::path folder_;
  std::size_t count_ = 0;
};

}  // namespace
}  // namespace splatlas

int main(int argc, char** argv) {
  using namespace splatlas;
  if (argc != 2) {
    fmt::print(stderr, "usage: {} FOLDER\n", argv[0]);
    return 2;
  }
  constexpr std::size_t kAtlases = 12, kWorkSeeds = 16;
  Random random(1);
  SeedWriter writer(argv[1]);
  for (std::size_t n = 0; n < kAtlases; ++n) {
    const AtlasContent content = seed_content(random);
    writer.write_of(
        content,
        encode_atlas(content, {.compact = n % 3 == 0, .threads = 1, .means_from = n % 2 == 0 ? 9u : 1000u})
            .value());
  }
  for (std::size_t n = 0; n < kWorkSeeds; ++n) writer.write_file(work_seed(random));
  fmt::print("{} seeds\n", writer.count());
}
