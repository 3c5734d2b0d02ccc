// Atomic creation of folders.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "format/io/output_file.h"
#include "format/result.h"

namespace splatlas {

/// Files that become a new folder together. Until commit() they have no names (format/io/staged_file.h),
/// except that every 128 files move into a folder with a random name beside the target. On file systems
/// without unnamed files they are in that folder from the start. Without commit() all of them are removed.
/// Requires DeferInterrupts during its lifetime. A killed process leaves at most the folder with the random
/// name. All errors are kFailed, with path and reason.
class OutputFolder {
 public:
  /// Checks the target as check_writable_folder() does: it must not exist, or be empty.
  [[nodiscard]] static Result<OutputFolder> create(const std::filesystem::path& target);
  ~OutputFolder();
  OutputFolder(OutputFolder&&) noexcept;
  OutputFolder& operator=(OutputFolder&&) noexcept;

  /// The target as given.
  [[nodiscard]] const std::filesystem::path& path() const;
  /// Creates a file of the folder. It becomes part of it by add().
  [[nodiscard]] Result<OutputFile> create_file(const std::string& name);
  /// Syncs the file and verifies its bytes, as OutputFile::commit() does.
  [[nodiscard]] Result<void> add(OutputFile file);
  /// Names the files, syncs the folder and gives it the target's name. Keeps permissions, group and owner of
  /// an empty folder that is there if possible.
  [[nodiscard]] Result<void> commit();

 private:
  struct Impl;
  explicit OutputFolder(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace splatlas
