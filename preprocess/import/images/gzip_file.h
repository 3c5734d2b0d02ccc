// Reads files that may be compressed by gzip.
#pragma once

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>

#include <zlib.h>

namespace splatlas {

struct GzipClose {
  void operator()(gzFile_s* file) const { gzclose(file); }
};
using GzipFile = std::unique_ptr<gzFile_s, GzipClose>;

/// Opens a file for reading, plain or compressed; null when it cannot be opened.
[[nodiscard]] inline GzipFile open_gzip_file(const std::filesystem::path& path) {
  return GzipFile(gzopen(path.c_str(), "rb"));
}

/// Fills all of `bytes`. False when the file ends before, or is damaged.
[[nodiscard]] inline bool read_all(gzFile_s& file, std::span<std::byte> bytes) {
  constexpr std::size_t kMaxRead = std::size_t{1} << 30;  // zlib counts in ints
  while (!bytes.empty()) {
    const int count = gzread(&file, bytes.data(), static_cast<unsigned>(std::min(bytes.size(), kMaxRead)));
    if (count <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
  return true;
}

}  // namespace splatlas
