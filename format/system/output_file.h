// Atomic replacement of files.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "format/result.h"

namespace splatlas {

/// A temporary file in the folder of its target. The target is unchanged until commit() and on all errors.
/// Files without commit() are removed, on interrupts, too (format/system/interrupts.h). The next create()
/// removes files of killed processes (format/system/temporary_entry.h). Follows links. Keeps permissions,
/// group and owner of the old file if possible; other hard links keep the old file. All errors are kFailed,
/// with target and reason.
class OutputFile {
 public:
  /// Creates the empty temporary file, with a name that ends in `ending`. Refuses an existing target that is
  /// not a regular file or is read-only.
  [[nodiscard]] static Result<OutputFile> create(const std::filesystem::path& target,
                                                 std::string_view ending = ".tmp");
  ~OutputFile();
  OutputFile(OutputFile&&) noexcept;
  OutputFile& operator=(OutputFile&&) noexcept;

  /// Path of the temporary file, for libraries that write to a path.
  [[nodiscard]] const std::filesystem::path& temporary() const;
  /// Appends bytes.
  [[nodiscard]] Result<void> write(std::span<const std::byte> bytes);

  /// Syncs the temporary file, verifies the checksum of the bytes of write() by reading them back, renames
  /// the file to the target, and syncs the folder. If only the last step fails, the target is the new file,
  /// and the message says so.
  [[nodiscard]] Result<void> commit();

 private:
  friend Result<void> commit_files(std::span<OutputFile> files);
  struct Impl;
  explicit OutputFile(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// Commits several files: renames them only after all are complete on disk.
[[nodiscard]] Result<void> commit_files(std::span<OutputFile> files);

/// Creates, writes and commits one file.
[[nodiscard]] Result<void> write_file(const std::filesystem::path& path, std::span<const std::byte> bytes);

/// The same for libraries that write to a path: calls write(temporary) with a path of the same extension.
[[nodiscard]] Result<void> write_atomically(
    const std::filesystem::path& path,
    const std::function<Result<void>(const std::filesystem::path&)>& write);
/// Replaces the temporary path in `message` by `path`.
[[nodiscard]] std::string with_path(std::string message, const std::filesystem::path& temporary,
                                    const std::filesystem::path& path);

}  // namespace splatlas
