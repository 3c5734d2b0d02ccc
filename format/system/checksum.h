// The checksum of headers, directories and chunks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace splatlas {

/// XXH3, 64 bits, seed 0. Tells damage, not forgery.
[[nodiscard]] std::uint64_t checksum_of(std::span<const std::byte> bytes);

/// The same of bytes that come piece by piece.
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
