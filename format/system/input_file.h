// A file, or bytes in memory, to read ranges from.
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

/// Read with pread, not mapped: a mapped file that somebody truncates ends the process with SIGBUS, a short
/// read is an error like any other (docs/atlas_format.md has the figures). The system reads ahead only once a
/// good part of the file has been asked for: a small selection costs its own pages. Moves, does not copy;
/// reading is thread-safe.
class InputFile {
 public:
  /// kFailed when it cannot be opened; kInvalidAtlas for folders, pipes and devices, of which nothing is
  /// read.
  [[nodiscard]] static Result<InputFile> open(const std::filesystem::path& path);
  InputFile(std::vector<std::byte> bytes, std::string name);
  InputFile(InputFile&& other) noexcept;
  ~InputFile();

  [[nodiscard]] const std::string& name() const { return name_; }
  /// When it was opened.
  [[nodiscard]] std::uint64_t size() const { return size_; }
  /// Fills `to` from `offset` on. kInvalidAtlas when the file has become shorter, kFailed when it cannot be
  /// read.
  [[nodiscard]] Result<void> read(std::uint64_t offset, std::span<std::byte> to) const;

 private:
  InputFile() = default;

  int descriptor_ = -1;  // -1: in memory
  std::vector<std::byte> bytes_;
  std::uint64_t size_ = 0;
  std::string name_;
  mutable std::atomic<std::uint64_t> asked_bytes_{0};
};

}  // namespace splatlas
