// Writes whole files, or none.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string_view>

#include "format/result.h"

namespace splatlas {

/// A file under a temporary name, in the folder of the one that it becomes. Until it is committed, and
/// whenever something fails, the target is what it was; a file that is not committed is removed, on
/// interrupts too (format/interrupts.h), and what killed processes left in the folder is removed by the next
/// create() there (format/temporary_entry.h). A link is followed; an old file's permissions, group and owner
/// are kept as far as may be; other hard links to it keep the old file. All errors are kFailed and name the
/// target and the reason.
class OutputFile {
 public:
  /// Makes the temporary file, empty. Its name ends in `ending`, for libraries that choose formats by it.
  /// Refuses a target that is anything but a regular file (a folder, a pipe, a device), and one that may not
  /// be written to.
  [[nodiscard]] static Result<OutputFile> create(const std::filesystem::path& target,
                                                 std::string_view ending = ".tmp");
  ~OutputFile();
  OutputFile(OutputFile&&) noexcept;
  OutputFile& operator=(OutputFile&&) noexcept;

  /// For libraries that write to a path.
  [[nodiscard]] const std::filesystem::path& temporary() const;
  /// Appends.
  [[nodiscard]] Result<void> write(std::span<const std::byte> bytes);

  /// Syncs the temporary file, reads what write() wrote back from the disk and compares its checksum, renames
  /// it to the target, and syncs the folder. Of an error in this last step alone the message says that the
  /// target is the new file.
  [[nodiscard]] Result<void> commit();

 private:
  friend Result<void> commit_files(std::span<OutputFile> files);
  struct Impl;
  explicit OutputFile(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// commit() of several: none is renamed before all are complete on the disk.
[[nodiscard]] Result<void> commit_files(std::span<OutputFile> files);

/// Creates, writes and commits one file.
[[nodiscard]] Result<void> write_file(const std::filesystem::path& path, std::span<const std::byte> bytes);

}  // namespace splatlas
