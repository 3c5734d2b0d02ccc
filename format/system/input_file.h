// Random-access input from a file or from memory.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "format/result.h"

namespace splatlas {

/// Reads with pread, not mmap: truncation of a mapped file ends the process with SIGBUS, a short read is an
/// ordinary error. Enables read-ahead only after a large part of the file was requested, so that small
/// selections read only their pages. Movable, not copyable. Reading is thread-safe.
class InputFile {
 public:
  /// kFailed if the file cannot be opened; kInvalidAtlas, without reading, for folders, pipes and devices.
  [[nodiscard]] static Result<InputFile> open(const std::filesystem::path& path);
  InputFile(std::vector<std::byte> bytes, std::string name);
  InputFile(InputFile&& other) noexcept;
  ~InputFile();

  [[nodiscard]] const std::string& name() const { return name_; }
  /// Size in bytes at the time of opening.
  [[nodiscard]] std::uint64_t size() const { return size_; }
  /// Fills `to` from `offset`. kInvalidAtlas if the file was truncated, kFailed if it cannot be read.
  [[nodiscard]] Result<void> read(std::uint64_t offset, std::span<std::byte> to) const;

 private:
  InputFile() = default;

  int descriptor_ = -1;  // -1 for bytes in memory
  std::vector<std::byte> bytes_;
  std::uint64_t size_ = 0;
  std::string name_;
  mutable std::atomic<std::uint64_t> asked_bytes_{0};
};

}  // namespace splatlas
