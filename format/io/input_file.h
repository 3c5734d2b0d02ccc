// Random-access input from a file or from memory.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "format/result.h"

namespace splatlas {

/// Fills `to` from `offset` of a file. Thread-safe.
using ReadBytes = std::function<Result<void>(std::uint64_t offset, std::span<std::byte> to)>;

/// Maps the file into memory, so that several processes share its pages, and copies ranges out of the mapping
/// by process_vm_readv(): a page that is gone, because the file was truncated or its disk fails, is an
/// ordinary error there, and SIGBUS elsewhere. Callers check the copy, which nobody else can change. Reads
/// with pread() on systems that refuse to map the file or to copy so. Reads no pages beyond the requested
/// ones until a large part of the file was requested. Movable, not copyable. Reading is thread-safe.
class InputFile {
 public:
  /// kFailed if the file cannot be opened, and for pipes; kInvalidAtlas, without reading, for folders and
  /// devices. Always reads with pread() if `map` is false.
  [[nodiscard]] static Result<InputFile> open(const std::filesystem::path& path, bool map = true);
  /// A file of this size that is read elsewhere.
  InputFile(std::uint64_t size, ReadBytes read, std::string name)
      : read_(std::move(read)), size_(size), name_(std::move(name)) {}
  InputFile(std::vector<std::byte> bytes, std::string name) : size_(bytes.size()), name_(std::move(name)) {
    read_ = [bytes = std::move(bytes)](std::uint64_t offset, std::span<std::byte> to) -> Result<void> {
      std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(offset), to.size(), to.begin());
      return {};
    };
  }
  InputFile(InputFile&& other) noexcept;
  ~InputFile();

  [[nodiscard]] const std::string& name() const { return name_; }
  /// Size in bytes at the time of opening.
  [[nodiscard]] std::uint64_t size() const { return size_; }
  [[nodiscard]] bool is_mapped() const { return mapping_ != nullptr; }
  /// Fills `to` from `offset`. kInvalidAtlas if the file was truncated, kFailed if it cannot be read.
  [[nodiscard]] Result<void> read(std::uint64_t offset, std::span<std::byte> to) const;

 private:
  InputFile() = default;
  void map();
  /// Enables read-ahead once a large part of the file was requested.
  void count(std::uint64_t bytes) const;
  /// Copies from the mapping. Returns the length of the valid prefix of `to`.
  [[nodiscard]] std::size_t copy_mapped(std::uint64_t offset, std::span<std::byte> to) const;
  [[nodiscard]] Result<void> read_positioned(std::uint64_t offset, std::span<std::byte> to) const;

  int descriptor_ = -1;
  const std::byte* mapping_ = nullptr;
  ReadBytes read_;  // none: from the descriptor
  std::uint64_t size_ = 0;
  std::string name_;
  mutable std::atomic<std::uint64_t> asked_bytes_{0};
};

}  // namespace splatlas
