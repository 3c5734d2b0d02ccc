// Bytes of a file that arrive in pieces.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <span>
#include <vector>

#include "format/result.h"

namespace splatlas {

struct ByteRange {
  std::uint64_t offset = 0, bytes = 0;
  friend bool operator==(const ByteRange&, const ByteRange&) = default;
};

/// Pieces of a file on a server. What a read misses is noted; someone gives it, and reads again. Thread-safe.
class RemoteBytes {
 public:
  /// Fills `to` from `offset`, out of one piece. kFailed if no piece holds the range.
  [[nodiscard]] Result<void> read(std::uint64_t offset, std::span<std::byte> to);
  void give(std::uint64_t offset, std::vector<std::byte> bytes);
  /// The ranges that reads have missed since the last call, in order and without gaps of a few KiB.
  [[nodiscard]] std::vector<ByteRange> take_missed();

 private:
  std::mutex mutex_;
  std::map<std::uint64_t, std::vector<std::byte>> pieces_;
  std::vector<ByteRange> missed_;
};

}  // namespace splatlas
