// Files that may be compressed by gzip.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include <zlib.h>

#include "format/result.h"

namespace splatlas {

/// A file open for reading, plain or compressed, of one or several gzip members. Not thread-safe.
class GzipFile {
 public:
  GzipFile() = default;
  /// kFailed if it cannot be opened, or if its compression contradicts its ending: .gz and .mgz are
  /// compressed.
  [[nodiscard]] static Result<GzipFile> open(const std::filesystem::path& path);

  [[nodiscard]] bool is_compressed() const { return gzdirect(stream_.get()) == 0; }
  /// Reads from the current position. Returns the number of bytes, fewer at the end of the file. kFailed for
  /// damage.
  [[nodiscard]] Result<std::size_t> read_some(std::span<std::byte> bytes);
  /// Reads `count` bytes from an offset of the decompressed file. kFailed if there are fewer.
  [[nodiscard]] Result<std::vector<std::byte>> read(std::uint64_t offset, std::uint64_t count);
  /// Reads a compressed file to its end, at most kMaxSurplus bytes, for its checksum. kFailed for damage.
  [[nodiscard]] Result<void> check_end();

 private:
  struct Close {
    void operator()(gzFile_s* stream) const { gzclose(stream); }
  };

  [[nodiscard]] Result<void> check_status(std::uint64_t read) const;

  std::filesystem::path path_;
  std::unique_ptr<gzFile_s, Close> stream_;
};

}  // namespace splatlas
