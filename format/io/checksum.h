// XXH3 checksums of headers, directories and chunks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace splatlas {

/// XXH3 with 64 bits and seed 0. Detects corruption, not tampering.
[[nodiscard]] std::uint64_t checksum_of(std::span<const std::byte> bytes);

/// Incremental form of checksum_of().
class RunningChecksum {
 public:
  RunningChecksum();
  ~RunningChecksum();
  RunningChecksum(const RunningChecksum&) = delete;
  RunningChecksum& operator=(const RunningChecksum&) = delete;

  void add(std::span<const std::byte> bytes);
  [[nodiscard]] std::uint64_t value() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace splatlas
