// Compression of pixels with zlib, in pieces.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <memory>
#include <span>
#include <vector>

#include "format/result.h"

namespace splatlas {

enum class DeflateWrapper { kZlib, kGzip };

/// Compresses the concatenated `parts` into one stream with zlib's `level`, 1 to 9, and calls `write` with
/// its pieces, in order. Stops at the first error of `write` and returns it; kLimit, with `path`, when out of
/// memory. Cost: one pass, 256 KiB of memory.
[[nodiscard]] Result<void> deflate_in_pieces(
    std::initializer_list<std::span<const std::byte>> parts, DeflateWrapper wrapper, int level,
    const std::filesystem::path& path, const std::function<Result<void>(std::span<const std::byte>)>& write);

/// A gzip file (RFC 1952) of masks: zlib's level 1 with its strategy of runs takes a seventh of the time of
/// level 6 and makes files of nearly the same size. Long runs of zeros are copies of one compressed block.
/// Throws std::bad_alloc.
class GzipRuns {
 public:
  GzipRuns();
  ~GzipRuns();
  void add(std::span<const std::byte> bytes);
  void add_zeros(std::uint64_t count);
  /// Ends the file. Call it once.
  [[nodiscard]] std::vector<std::byte> finish();

 private:
  struct Stream;
  /// Deflates and forgets the window, so that any block can follow.
  void deflate_block(std::span<const std::byte> bytes, int flush);

  std::unique_ptr<Stream> stream_;
  std::vector<std::byte> packed_;
  unsigned long checksum_ = 0;
  std::uint64_t bytes_ = 0;
};

}  // namespace splatlas
