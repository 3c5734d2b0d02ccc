// Atomic replacement of files.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "format/result.h"

namespace splatlas {

struct UnfinishedFile;

/// A new file in the folder of its target, without a name there (format/io/staged_file.h). The target is
/// unchanged until commit() and on all errors. Files without commit() vanish, also when the process is
/// killed. Follows links. Keeps permissions (without setuid, setgid and sticky bits), group and owner of the
/// old file if possible; nobody else can read the new one before commit(). Other hard links keep the old
/// file. All errors are kFailed, with target and reason.
class OutputFile {
 public:
  /// Creates the empty file. Refuses an existing target that is not a regular file or is read-only.
  [[nodiscard]] static Result<OutputFile> create(const std::filesystem::path& target);
  ~OutputFile();
  OutputFile(OutputFile&&) noexcept;
  OutputFile& operator=(OutputFile&&) noexcept;

  /// Path to the unfinished file, for libraries that write to a path. Has no ending.
  [[nodiscard]] std::filesystem::path temporary() const;
  /// Appends bytes.
  [[nodiscard]] Result<void> write(std::span<const std::byte> bytes);

  /// Syncs the file, verifies the checksum of the bytes of write() by reading them back, gives the file the
  /// target's name, and syncs the folder. If only the last step fails, the target is the new file, and the
  /// message says so.
  [[nodiscard]] Result<void> commit();

 private:
  friend Result<void> commit_files(std::span<OutputFile> files);
  friend class OutputFolder;
  explicit OutputFile(std::unique_ptr<UnfinishedFile> impl);
  std::unique_ptr<UnfinishedFile> impl_;
};

/// Commits several files: names them only after all are complete on disk.
[[nodiscard]] Result<void> commit_files(std::span<OutputFile> files);

/// Creates and writes a file, and adds it to those that commit_files() names.
[[nodiscard]] Result<void> add_file(const std::filesystem::path& path, std::span<const std::byte> bytes,
                                    std::vector<OutputFile>& files);

/// Creates, writes and commits one file.
[[nodiscard]] Result<void> write_file(const std::filesystem::path& path, std::span<const std::byte> bytes);

}  // namespace splatlas
