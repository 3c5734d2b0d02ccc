// Bytes of files in tests.
#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
#include <string>
#include <string_view>

namespace splatlas {

/// The bytes of a file; empty if it cannot be read.
[[nodiscard]] inline std::string read_bytes(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Writes a file in place, over an old one. Returns success.
inline bool write_bytes(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  file.close();
  return file.good();
}

inline bool write_bytes(const std::filesystem::path& path, std::string_view bytes) {
  return write_bytes(path, std::as_bytes(std::span(bytes)));
}

}  // namespace splatlas
