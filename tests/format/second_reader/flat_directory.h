// Directory of the second reader: FlatBuffer bytes, parsed by hand.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <vector>

namespace splatlas::second {

template <typename T>
T number_at(const std::vector<std::byte>& bytes, std::size_t at) {
  if (at + sizeof(T) > bytes.size()) throw std::runtime_error("beyond the end");
  T value{};
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

struct ClassRow {
  std::uint64_t voxels = 0;
  std::array<std::int64_t, 3> box_first{}, box_last{};
  std::array<std::uint32_t, 3> run_bytes{};
  std::vector<std::uint32_t> members;  ///< structure * 4 + part
  bool normals_fitted = false;
};
struct SectionRow {
  std::uint32_t kind = 0, chunks = 0, chunk_bytes = 0, shared_bytes = 0;
};
struct ChunkRow {
  std::uint64_t checksum = 0;
  std::uint32_t stored_bytes = 0;
  std::uint8_t codec = 0, filter = 0;
};

struct FlatDirectory {
  std::array<std::int64_t, 3> size{};  ///< storage grid
  std::uint8_t value_type = 0;
  std::vector<ClassRow> classes;
  std::vector<std::uint64_t> fingerprints;  ///< per class
  std::vector<std::uint32_t> mean_blocks;   ///< [group]; empty: none
  std::vector<SectionRow> sections;
  std::vector<ChunkRow> chunks;
};

[[nodiscard]] FlatDirectory read_directory(const std::vector<std::byte>& bytes);

}  // namespace splatlas::second
